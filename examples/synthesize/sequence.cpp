// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/sequence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include <hmcdyn/types.hpp>

#include "synthesize/parallel.hpp"
#include "synthesize/random.hpp"
#include "synthesize/scene_catalog.hpp"
#include "synthesize/trajectory_file.hpp"

namespace hmcdyn::synthesize {
namespace {

namespace fs = std::filesystem;

/// What is left of a frame once its pictures are on the disk.
struct FrameRecord {
  Eigen::Isometry3d camera_to_world = Eigen::Isometry3d::Identity();
  std::vector<DetectionBox> boxes;
};

void require(bool ok, const std::string& name, const std::string& value,
             const std::string& expected) {
  if (!ok) {
    throw std::invalid_argument(name + " is " + value + ", expected " + expected);
  }
}

void check(const SequenceOptions& o) {
  require(o.frames > 0, "frames", std::to_string(o.frames), "at least 1");
  require(o.width >= 32 && o.width <= 4096, "width", std::to_string(o.width), "32..4096 px");
  require(o.height >= 32 && o.height <= 4096, "height", std::to_string(o.height), "32..4096 px");
  require(o.exposure >= 0.0 && o.exposure <= 1.0 / kFrameRate, "exposure",
          std::to_string(o.exposure), "0..0.033 s");
  require(o.moving_speed >= 0.0, "moving speed", std::to_string(o.moving_speed), ">= 0 m/s");
  require(o.box_drop >= 0.0 && o.box_drop <= 1.0, "box drop", std::to_string(o.box_drop), "0..1");
  require(o.box_jitter >= 0.0, "box jitter", std::to_string(o.box_jitter), ">= 0 px");
  require(o.threads >= 0, "threads", std::to_string(o.threads), ">= 0");
}

void prepareFolder(const SequenceOptions& options) {
  std::error_code error;
  const fs::path& folder = options.output;
  require(!folder.empty(), "output", "empty", "a folder");
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    throw std::invalid_argument("output is " + folder.string() + ", a file; expected a folder");
  }
  const bool filled = fs::exists(folder, error) && !fs::is_empty(folder, error);
  if (error) {
    throw std::runtime_error(folder.string() + ": " + error.message());
  }
  if (filled && !options.overwrite) {
    throw std::invalid_argument("output is " + folder.string() +
                                ", which is not empty; expected a new folder, or --overwrite");
  }
  fs::remove(folder / kSystematicErrorFile, error);  // of another sensor
  for (const char* part : {"rgb", "depth", "mask"}) {
    // Pictures of an earlier, longer sequence must not stay behind.
    fs::remove_all(folder / part, error);
    if (!error) {
      fs::create_directories(folder / part, error);
    }
    if (error) {
      throw std::runtime_error((folder / part).string() + ": cannot be made: " + error.message());
    }
  }
}

void writePicture(const fs::path& path, const cv::Mat& picture) {
  // Noise does not compress; a light setting makes up for it in time.
  const std::vector<int> settings{cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY,
                                  cv::IMWRITE_PNG_STRATEGY_RLE};
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", picture, bytes, settings);
  std::ofstream file(path, std::ios::binary);
  file << std::string(bytes.begin(), bytes.end());
  file.close();
  if (!file) {
    throw std::runtime_error(path.string() + ": cannot be written");
  }
}

class TextFile {
 public:
  explicit TextFile(const fs::path& path) : path_(path), file_(path) {}
  template <class... Values>
  void line(const char* format, Values... values) {
    std::array<char, 512> text{};
    if constexpr (sizeof...(values) == 0) {
      std::snprintf(text.data(), text.size(), "%s", format);
    } else {
      std::snprintf(text.data(), text.size(), format, values...);
    }
    file_ << text.data() << '\n';
  }
  void close() {
    file_.close();
    if (!file_) {
      throw std::runtime_error(path_.string() + ": cannot be written");
    }
  }

 private:
  fs::path path_;
  std::ofstream file_;
};

double stampOf(std::size_t frame) { return kFirstStamp + static_cast<double>(frame) / kFrameRate; }

std::string stampText(std::size_t frame) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6f", stampOf(frame));
  return text.data();
}

/// Boxes around the visible pixels of each person, as a detector with faults would report them.
std::vector<DetectionBox> boxesOf(const RenderedFrame& frame, const Scene& scene,
                                  const SequenceOptions& options, std::size_t index) {
  struct Extent {
    int pixels = 0;
    int u_min = std::numeric_limits<int>::max();
    int v_min = std::numeric_limits<int>::max();
    int u_max = -1;
    int v_max = -1;
  };
  std::vector<Extent> extents(scene.movers.size());
  for (int v = 0; v < frame.mover.rows; ++v) {
    for (int u = 0; u < frame.mover.cols; ++u) {
      const auto mover = frame.mover.at<std::int16_t>(v, u);
      if (mover >= 0) {
        Extent& e = extents[static_cast<std::size_t>(mover)];
        ++e.pixels;
        e.u_min = std::min(e.u_min, u);
        e.v_min = std::min(e.v_min, v);
        e.u_max = std::max(e.u_max, u);
        e.v_max = std::max(e.v_max, v);
      }
    }
  }
  const double needed = options.box_pixels * (options.width * options.height / (640.0 * 480.0));
  Random random(options.seed, 9000000 + index);
  std::vector<DetectionBox> boxes;
  for (std::size_t m = 0; m < extents.size(); ++m) {
    const Extent& e = extents[m];
    // The same draws for every person, seen or not, so that one does not change another's.
    const bool dropped = random.chance(options.box_drop);
    std::array<double, 4> shift{};
    for (double& s : shift) {
      s = options.box_jitter * random.normal();
    }
    const double certainty = random.uniform(0.45, 0.95);
    if (!scene.movers[m].is_person || e.pixels == 0 || e.pixels < needed || dropped) {
      continue;
    }
    const auto clamped = [](double x, int size) {
      return static_cast<float>(std::clamp(x, 0.0, size - 1.0));
    };
    const bool faulty = options.box_drop > 0.0 || options.box_jitter > 0.0;
    boxes.push_back(
        {clamped(e.u_min + shift[0], options.width), clamped(e.v_min + shift[1], options.height),
         clamped(e.u_max + shift[2], options.width), clamped(e.v_max + shift[3], options.height),
         kPersonClassId, faulty ? static_cast<float>(certainty) : 1.0f});
  }
  return boxes;
}

void writeLists(const SequenceOptions& options, const std::vector<FrameRecord>& records) {
  const fs::path& folder = options.output;
  TextFile rgb(folder / "rgb.txt");
  TextFile depth(folder / "depth.txt");
  TextFile both(folder / "associations.txt");
  TextFile truth(folder / "groundtruth.txt");
  TextFile boxes(folder / "boxes.txt");
  rgb.line("# color images\n# rendered scene '%s', seed %llu\n# timestamp filename",
           options.scene.c_str(), static_cast<unsigned long long>(options.seed));
  depth.line("# depth maps\n# rendered scene '%s', seed %llu\n# timestamp filename",
             options.scene.c_str(), static_cast<unsigned long long>(options.seed));
  truth.line("# ground truth trajectory, camera in the world\n# timestamp tx ty tz qx qy qz qw");
  boxes.line(
      "# boxes of people, borders included (px); class 0 = person\n"
      "# timestamp class x_min y_min x_max y_max score");
  for (std::size_t i = 0; i < records.size(); ++i) {
    const std::string stamp = stampText(i);
    const char* s = stamp.c_str();
    rgb.line("%s rgb/%s.png", s, s);
    depth.line("%s depth/%s.png", s, s);
    both.line("%s rgb/%s.png %s depth/%s.png", s, s, s, s);
    const Eigen::Vector3d t = records[i].camera_to_world.translation();
    Eigen::Quaterniond q(records[i].camera_to_world.linear());
    if (q.w() < 0.0) {
      q.coeffs() = -q.coeffs();
    }
    truth.line("%s %.9f %.9f %.9f %.9f %.9f %.9f %.9f", s, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(),
               q.w());
    for (const DetectionBox& b : records[i].boxes) {
      boxes.line("%s %d %.2f %.2f %.2f %.2f %.3f", s, b.class_id, static_cast<double>(b.x_min),
                 static_cast<double>(b.y_min), static_cast<double>(b.x_max),
                 static_cast<double>(b.y_max), static_cast<double>(b.score));
    }
  }
  for (TextFile* file : {&rgb, &depth, &both, &truth, &boxes}) {
    file->close();
  }
}

void writeCalibration(const SequenceOptions& options) {
  const PinholeCamera camera = scaledCamera(options.width, options.height);
  TextFile file(options.output / "calibration.yaml");
  file.line("# Pinhole camera of the rendered sequence: pixels, pixel (0, 0) is a pixel's centre.");
  file.line("fx: %.9g\nfy: %.9g\ncx: %.9g\ncy: %.9g", camera.fx, camera.fy, camera.cx, camera.cy);
  file.line("distortion: [0, 0, 0, 0, 0]");
  file.line("depth_factor: %.9g", kDepthFactor);
  file.line("width: %d\nheight: %d", options.width, options.height);
  file.line("frame_rate: %.9g", kFrameRate);
  if (options.noise != NoiseModel::kKinectSystematic) {
    file.line(
        "depth_error: {systematic_linear: 0, systematic_quadratic: 0}  # a calibrated camera's");
  }
  file.close();
}

}  // namespace

PinholeCamera scaledCamera(int width, int height) {
  // Pixel centres are whole numbers, so the picture's corner is at -0.5.
  const double sx = width / 640.0;
  const double sy = height / 480.0;
  return {535.4 * sx, 539.2 * sy, (320.1 + 0.5) * sx - 0.5, (247.6 + 0.5) * sy - 0.5};
}

void writeSequence(const SequenceOptions& options,
                   const std::function<void(std::size_t)>& progress) {
  check(options);
  const int threads = options.threads > 0
                          ? options.threads
                          : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  SceneOptions scene_options;
  scene_options.seed = options.seed;
  scene_options.seconds = options.frames / kFrameRate;
  scene_options.threads = threads;
  scene_options.max_texture = options.width > 320 ? 1024 : 512;
  BuiltScene built = buildScene(options.scene, scene_options);
  if (!options.trajectory.empty()) {
    built.scene.camera = pathFromFile(options.trajectory, built.scene.camera(0.0),
                                      scene_options.seconds, built.bounds);
  }
  prepareFolder(options);
  writeCalibration(options);

  RenderOptions render_options;
  render_options.width = options.width;
  render_options.height = options.height;
  render_options.camera = scaledCamera(options.width, options.height);
  render_options.exposure = options.noise != NoiseModel::kNone ? options.exposure : 0.0;
  render_options.moving_speed = options.moving_speed;
  const Sensor sensor(options.noise, {}, {options.width, options.height}, options.seed);
  if (options.noise == NoiseModel::kKinectSystematic) {
    writeSystematicError(sensor.systematicError(), options.output / kSystematicErrorFile);
  }

  // Each thread renders whole frames with a renderer of its own; a frame depends on its number
  // alone, so the order in which they are finished does not matter.
  std::vector<FrameRecord> records(static_cast<std::size_t>(options.frames));
  std::vector<std::unique_ptr<Renderer>> idle;
  std::mutex mutex;
  std::size_t done = 0;
  parallelFor(records.size(), threads, [&](std::size_t i) {
    std::unique_ptr<Renderer> renderer;
    {
      const std::lock_guard<std::mutex> lock(mutex);
      if (!idle.empty()) {
        renderer = std::move(idle.back());
        idle.pop_back();
      }
    }
    if (!renderer) {
      renderer = std::make_unique<Renderer>(built.scene, render_options);
    }
    const double time = static_cast<double>(i) / kFrameRate;
    const RenderedFrame frame = renderer->render(time);
    const SensorFrame measured = sensor.measure(frame, i, time);
    const std::string name = stampText(i) + ".png";
    writePicture(options.output / "rgb" / name, measured.color);
    writePicture(options.output / "depth" / name, measured.depth);
    writePicture(options.output / "mask" / name, frame.mask);
    records[i] = {frame.camera_to_world, boxesOf(frame, built.scene, options, i)};
    const std::lock_guard<std::mutex> lock(mutex);
    idle.push_back(std::move(renderer));
    ++done;
    if (progress) {
      progress(done);
    }
  });
  writeLists(options, records);
}

}  // namespace hmcdyn::synthesize
