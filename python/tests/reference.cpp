// SPDX-License-Identifier: BSD-3-Clause
// What the library says in C++, for the tests of the Python module: raw arrays from a file, raw
// results to another. Prints what a call took (us): the least of many for the stage; of the
// processors' time for frames, the median. Five times.
//
//   reference stage|frames INPUT OUTPUT
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/filter_stage.hpp>
#include <hmcdyn/frame_filter.hpp>

namespace {

template <class T>
std::vector<T> readMany(std::istream& in, std::size_t count) {
  std::vector<T> values(count);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): raw arrays
  in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(T)));
  if (!in) {
    throw std::runtime_error("the input ends too early");
  }
  return values;
}

template <class T>
T readOne(std::istream& in) {
  return readMany<T>(in, 1).front();
}

std::size_t readCount(std::istream& in) { return static_cast<std::size_t>(readOne<int>(in)); }

template <class T>
void write(std::ostream& out, const std::vector<T>& values) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): raw arrays
  out.write(reinterpret_cast<const char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(T)));
}

std::vector<hmcdyn::DetectionBox> readBoxes(std::istream& in) {
  std::vector<hmcdyn::DetectionBox> boxes;
  const std::size_t count = readCount(in);
  for (std::size_t i = 0; i < count; ++i) {
    const auto corners = readMany<float>(in, 4);
    boxes.push_back({corners[0], corners[1], corners[2], corners[3]});
  }
  return boxes;
}

/// What work took (us).
template <class Work>
double microseconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
      .count();
}

void runStage(std::istream& in, std::ostream& out) {
  const std::size_t n = readCount(in);
  const auto u = readMany<float>(in, n);
  const auto v = readMany<float>(in, n);
  const auto depth = readMany<float>(in, n);
  const auto distance = readMany<float>(in, n);
  const std::vector<hmcdyn::DetectionBox> boxes = readBoxes(in);
  constexpr int kCalls = 200;
  hmcdyn::FilterStageResult result;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kCalls; ++i) {
    least = std::min(least, microseconds([&] {
                       result = hmcdyn::filterKeyPoints({u, v, depth}, distance, boxes);
                     }));
  }
  std::cout << least << '\n';
  write(out, result.label);
  write(out, result.weight);
  write(out, result.cluster);
}

void runFrames(std::istream& in, std::ostream& out) {
  const std::size_t frames = readCount(in);
  const int height = readOne<int>(in);
  const int width = readOne<int>(in);
  const auto pixels = static_cast<std::size_t>(height) * static_cast<std::size_t>(width);
  hmcdyn::FrameFilter filter;
  std::vector<double> times;
  for (std::size_t i = 0; i < frames; ++i) {
    hmcdyn::FrameInput frame;
    frame.timestamp = readOne<double>(in);
    auto gray = readMany<std::uint8_t>(in, pixels);
    auto depth = readMany<float>(in, pixels);
    frame.gray = cv::Mat(height, width, CV_8UC1, gray.data());
    frame.depth = cv::Mat(height, width, CV_32FC1, depth.data());
    std::vector<cv::KeyPoint> points(readCount(in));
    for (cv::KeyPoint& point : points) {
      point.pt.x = readOne<float>(in);
      point.pt.y = readOne<float>(in);
    }
    frame.key_points = points;
    const std::vector<hmcdyn::DetectionBox> boxes = readBoxes(in);
    hmcdyn::FrameFilterResult result;
    const std::clock_t start = std::clock();
    result = filter.filter(frame, boxes);
    times.push_back(1e6 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    write(out, result.keep);
    write(out, result.weight);
    write(out, result.lambda);
    write(out, result.label);
  }
  std::sort(times.begin(), times.end());
  std::cout << times.at(times.size() / 2) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 4) {
      throw std::runtime_error("usage: reference stage|frames INPUT OUTPUT");
    }
    // What a process's first frames take is the system's memory in large parts.
    constexpr int kRounds = 5;
    for (int round = 0; round < kRounds; ++round) {
      std::ifstream in(argv[2], std::ios::binary);
      std::ofstream out(argv[3], std::ios::binary);
      (std::string(argv[1]) == "stage" ? runStage : runFrames)(in, out);
    }
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
