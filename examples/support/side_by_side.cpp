// SPDX-License-Identifier: BSD-3-Clause
// Puts annotated frames of two runs beside each other, a row a frame.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace {

/// The pictures of a folder, by name.
std::vector<std::filesystem::path> picturesIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".png") {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

cv::Mat read(const std::filesystem::path& file) {
  cv::Mat picture = cv::imread(file.string());
  if (picture.empty()) {
    throw std::runtime_error(file.string() + ": cannot be read");
  }
  return picture;
}

void run(const std::filesystem::path& left, const std::filesystem::path& right, int rows,
         const std::filesystem::path& output) {
  const std::vector<std::filesystem::path> frames = picturesIn(left);
  if (frames.empty() || rows < 1) {
    throw std::runtime_error(left.string() + ": no frames to show");
  }
  std::vector<cv::Mat> pairs;
  const auto wanted = std::min(frames.size(), static_cast<std::size_t>(rows));
  pairs.reserve(wanted);
  for (std::size_t k = 0; k < wanted; ++k) {
    const std::filesystem::path& frame = frames[(2 * k + 1) * frames.size() / (2 * wanted)];
    cv::Mat pair;
    cv::hconcat(read(frame), read(right / frame.filename()), pair);
    pairs.push_back(pair);
  }
  cv::Mat picture;
  cv::vconcat(pairs, picture);
  if (!cv::imwrite(output.string(), picture)) {
    throw std::runtime_error(output.string() + ": cannot be written");
  }
}

}  // namespace

int main(int argc, char** argv) {
  constexpr int kBadUsage = 2;
  if (argc != 5) {
    std::fprintf(stderr,
                 "usage: hmcdyn_side_by_side LEFT_FRAMES RIGHT_FRAMES ROWS OUTPUT.png\n"
                 "Puts annotated frames (hmcdyn_slam --annotate) of two runs beside each other:\n"
                 "ROWS of them, spread over the run.\n");
    return kBadUsage;
  }
  try {
    run(argv[1], argv[2], std::stoi(argv[3]), argv[4]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hmcdyn_side_by_side: %s\n", error.what());
    return 1;
  }
}
