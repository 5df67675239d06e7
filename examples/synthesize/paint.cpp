// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/paint.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace hmcdyn::synthesize::paint {

cv::Mat smoothNoise(cv::Size size, int cells, int octaves, double persistence, Random& random) {
  cv::Mat sum = cv::Mat::zeros(size, CV_32FC1);
  double amplitude = 1.0;
  double total = 0.0;
  for (int octave = 0; octave < octaves; ++octave, cells *= 2, amplitude *= persistence) {
    const int columns = std::min(cells, size.width);
    const int rows = std::max(1, std::min(size.height, columns * size.height / size.width));
    cv::Mat coarse(rows, columns, CV_32FC1);
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < columns; ++x) {
        coarse.at<float>(y, x) = static_cast<float>(random.uniform(-amplitude, amplitude));
      }
    }
    // A wrapped border makes the interpolation continue on the other side.
    constexpr int kBorder = 2;
    cv::Mat wrapped;
    cv::copyMakeBorder(coarse, wrapped, kBorder, kBorder, kBorder, kBorder, cv::BORDER_WRAP);
    const int step_x = std::max(1, size.width / columns);
    const int step_y = std::max(1, size.height / rows);
    cv::Mat fine;
    cv::resize(wrapped, fine, {wrapped.cols * step_x, wrapped.rows * step_y}, 0.0, 0.0,
               cv::INTER_CUBIC);
    cv::Mat cut =
        fine(cv::Rect(kBorder * step_x, kBorder * step_y, columns * step_x, rows * step_y));
    if (cut.size() != size) {
      cv::Mat fitted;
      cv::resize(cut, fitted, size);
      cut = fitted;
    }
    sum += cut;
    total += amplitude;
  }
  return sum * (1.6 / total);
}

cv::Point randomPoint(Random& random, const Range& x, const Range& y) {
  const int drawn_y = random.integer(y.low, y.high);
  const int drawn_x = random.integer(x.low, x.high);
  return {drawn_x, drawn_y};
}

cv::Mat plain(cv::Size size, const Color& color) {
  cv::Mat picture(size, CV_8UC3, color);
  return picture;
}

void addField(cv::Mat& picture, const cv::Mat& field, double amplitude) {
  const auto strength = static_cast<float>(amplitude);
  for (int y = 0; y < picture.rows; ++y) {
    auto* row = picture.ptr<cv::Vec3b>(y);
    const auto* values = field.ptr<float>(y);
    for (int x = 0; x < picture.cols; ++x) {
      const float change = strength * values[x];
      for (int c = 0; c < 3; ++c) {
        row[x][c] = cv::saturate_cast<std::uint8_t>(static_cast<float>(row[x][c]) + change);
      }
    }
  }
}

void addGrain(cv::Mat& picture, double deviation, Random& random) {
  for (int y = 0; y < picture.rows; ++y) {
    auto* row = picture.ptr<cv::Vec3b>(y);
    for (int x = 0; x < picture.cols; ++x) {
      // The sum of three uniform numbers is near enough to a normal one, and cheap.
      const std::uint64_t bits = random.bits();
      const double sum = static_cast<double>((bits & 0xffffU) + ((bits >> 16U) & 0xffffU) +
                                             ((bits >> 32U) & 0xffffU)) /
                         65536.0;
      const double change = deviation * 2.0 * (sum - 1.5);
      for (int c = 0; c < 3; ++c) {
        row[x][c] = cv::saturate_cast<std::uint8_t>(row[x][c] + change);
      }
    }
  }
}

Color randomColor(Random& random, double low, double high) {
  const double b = random.uniform(low, high);
  const double g = random.uniform(low, high);
  const double r = random.uniform(low, high);
  return {b, g, r};
}

Color scaled(const Color& color, double factor) {
  return {std::min(255.0, color[0] * factor), std::min(255.0, color[1] * factor),
          std::min(255.0, color[2] * factor)};
}

std::string randomWord(Random& random, int min_letters, int max_letters) {
  static constexpr char kLetters[] = "eeeetttaaaoooiinnsshhrrdlcumwfgypbvkxjqz";
  std::string word(static_cast<std::size_t>(random.integer(min_letters, max_letters)), ' ');
  for (char& letter : word) {
    letter = kLetters[random.integer(0, static_cast<int>(sizeof kLetters) - 2)];
  }
  return word;
}

std::string randomWords(Random& random, const Range& first, const std::string& between,
                        const Range& second) {
  const std::string last = randomWord(random, second.low, second.high);
  return randomWord(random, first.low, first.high) + between + last;
}

void writeLines(cv::Mat& picture, const cv::Rect& area, int line_height, const Color& ink,
                Random& random) {
  const double scale = line_height / 34.0;
  const int thickness = line_height > 26 ? 2 : 1;
  for (int y = area.y + line_height; y <= area.y + area.height; y += line_height) {
    const int end = area.x + (random.chance(0.15) ? area.width * 2 / 3 : area.width);
    for (int x = area.x; x < end;) {
      const std::string word = randomWord(random);
      const int width =
          cv::getTextSize(word, cv::FONT_HERSHEY_SIMPLEX, scale, thickness, nullptr).width;
      if (x + width > end) {
        break;
      }
      cv::putText(picture, word, {x, y - line_height / 4}, cv::FONT_HERSHEY_SIMPLEX, scale, ink,
                  thickness, cv::LINE_AA);
      x += width + line_height / 2;
    }
  }
}

}  // namespace hmcdyn::synthesize::paint
