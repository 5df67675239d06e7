// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "synthesize/paint.hpp"

namespace hmcdyn::synthesize::paint {
namespace {

void drawChecks(cv::Mat& picture, const Color& second, Random& random) {
  const int period = random.integer(28, 44);
  const int band = period / 2;
  cv::Mat overlay = picture.clone();
  for (int x = 0; x < picture.cols; x += period) {
    cv::rectangle(overlay, cv::Rect(x, 0, band, picture.rows), second, cv::FILLED);
  }
  cv::addWeighted(overlay, 0.5, picture, 0.5, 0.0, picture);
  overlay = picture.clone();
  for (int y = 0; y < picture.rows; y += period) {
    cv::rectangle(overlay, cv::Rect(0, y, picture.cols, band), second, cv::FILLED);
  }
  cv::addWeighted(overlay, 0.5, picture, 0.5, 0.0, picture);
  const Color line = randomColor(random, 20, 250);
  for (int i = period * 3 / 4; i < picture.cols; i += period) {
    cv::line(picture, {i, 0}, {i, picture.rows}, line, 2);
    cv::line(picture, {0, i}, {picture.cols, i}, line, 2);
  }
}

void drawStripes(cv::Mat& picture, const Color& second, Random& random) {
  const int period = random.integer(24, 46);
  for (int y = 0; y < picture.rows; y += period) {
    cv::rectangle(picture, cv::Rect(0, y, picture.cols, period / 2 - random.integer(0, 4)), second,
                  cv::FILLED);
  }
}

void drawPrint(cv::Mat& picture, const Color& second, Random& random) {
  const cv::Point middle(picture.cols / 2, picture.rows * 2 / 5);
  cv::circle(picture, middle, 52, second, cv::FILLED, cv::LINE_AA);
  for (int i = 0; i < 8; ++i) {
    const cv::Point p = middle + randomPoint(random, {-48, 48}, {-48, 48});
    const Color color = randomColor(random);
    cv::circle(picture, p, random.integer(5, 16), color, cv::FILLED, cv::LINE_AA);
  }
  cv::putText(picture, randomWord(random, 4, 6), {middle.x - 66, middle.y + 95},
              cv::FONT_HERSHEY_TRIPLEX, 1.3, second, 3, cv::LINE_AA);
  cv::putText(picture, randomWord(random, 2, 3), {20, middle.y + 30}, cv::FONT_HERSHEY_TRIPLEX, 2.2,
              second, 5, cv::LINE_AA);
  cv::putText(picture, randomWord(random, 2, 3), {picture.cols - 110, middle.y + 30},
              cv::FONT_HERSHEY_TRIPLEX, 2.2, second, 5, cv::LINE_AA);
}

}  // namespace

cv::Mat cloth(Cloth kind, const Color& color, const Color& second, std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({512, 512}, color);
  switch (kind) {
    case Cloth::kChecks:
      drawChecks(picture, second, random);
      break;
    case Cloth::kStripes:
      drawStripes(picture, second, random);
      break;
    case Cloth::kPrint:
      drawPrint(picture, second, random);
      break;
    case Cloth::kCamouflage: {
      const cv::Mat field = smoothNoise(picture.size(), 9, 3, 0.6, random);
      picture.setTo(second, field > 0.12f);
      picture.setTo(scaled(color, 0.5), field < -0.2f);
      break;
    }
    case Cloth::kKnit:
      for (int y = 0; y < picture.rows; y += 6) {
        for (int x = 0; x < picture.cols; x += 8) {
          cv::line(picture, {x, y}, {x + 4, y + 4}, scaled(color, random.uniform(0.6, 0.85)), 1);
          cv::line(picture, {x + 4, y + 4}, {x + 8, y}, scaled(color, random.uniform(1.1, 1.4)), 1);
        }
      }
      break;
    case Cloth::kDenim:
      addGrain(picture, 14.0, random);
      cv::line(picture, {128, 0}, {128, 511}, scaled(color, 1.5), 2);
      cv::line(picture, {384, 0}, {384, 511}, scaled(color, 1.5), 2);
      break;
    case Cloth::kPlain:
      break;
  }
  // Folds and seams.
  addField(picture, smoothNoise(picture.size(), 5, 4, 0.65, random), 20.0);
  for (int fold = 0; fold < 14; ++fold) {
    const cv::Point p = randomPoint(random, {0, 511}, {0, 511});
    const cv::Point q = p + randomPoint(random, {-60, 60}, {-60, 60});
    const auto& base = picture.at<cv::Vec3b>(p);
    const double shade = random.chance(0.7) ? 0.65 : 1.3;
    cv::line(picture, p, q, Color(base[0] * shade, base[1] * shade, base[2] * shade), 2,
             cv::LINE_AA);
  }
  addGrain(picture, 4.0, random);
  return picture;
}

cv::Mat skin(const Color& color, std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({128, 128}, color);
  addField(picture, smoothNoise(picture.size(), 5, 4, 0.6, random), 11.0);
  for (int i = 0; i < 14; ++i) {
    cv::circle(picture, {random.integer(0, 127), random.integer(0, 127)}, 1, scaled(color, 0.75),
               cv::FILLED, cv::LINE_AA);
  }
  return picture;
}

cv::Mat head(const Color& skin_color, const Color& hair, bool beard, bool glasses,
             std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({512, 256}, hair);
  for (int i = 0; i < 900; ++i) {
    const cv::Point p = randomPoint(random, {0, 511}, {0, 255});
    const Color color = scaled(hair, random.uniform(0.5, 1.7));
    cv::line(picture, p, {p.x + random.integer(-6, 6), p.y + random.integer(8, 24)}, color, 1,
             cv::LINE_AA);
  }
  cv::rectangle(picture, {0, 205, 512, 51}, skin_color, cv::FILLED);  // neck
  cv::ellipse(picture, {256, 160}, {98, 92}, 0, 0, 360, skin_color, cv::FILLED, cv::LINE_AA);
  for (const int x : {128, 384}) {  // ears
    cv::ellipse(picture, {x, 155}, {16, 26}, 0, 0, 360, scaled(skin_color, 0.9), cv::FILLED,
                cv::LINE_AA);
    cv::ellipse(picture, {x, 155}, {8, 16}, 0, 0, 360, scaled(skin_color, 0.65), 2, cv::LINE_AA);
  }
  if (beard) {
    cv::ellipse(picture, {256, 205}, {72, 44}, 0, 0, 180, scaled(hair, 1.1), cv::FILLED,
                cv::LINE_AA);
    cv::ellipse(picture, {256, 190}, {40, 10}, 0, 0, 360, scaled(hair, 1.0), cv::FILLED,
                cv::LINE_AA);
  }
  for (const int side : {-1, 1}) {
    const cv::Point eye(256 + side * 38, 138);
    cv::ellipse(picture, eye, {17, 8}, 0, 0, 360, Color(235, 238, 240), cv::FILLED, cv::LINE_AA);
    cv::circle(picture, eye, 7, Color(60, 50, 35), cv::FILLED, cv::LINE_AA);
    cv::ellipse(picture, {eye.x, eye.y - 4}, {19, 10}, 0, 190, 350, scaled(hair, 0.5), 2,
                cv::LINE_AA);
    cv::line(picture, {eye.x - 20, eye.y - 20}, {eye.x + 20, eye.y - 22}, scaled(hair, 0.7), 6,
             cv::LINE_AA);
    if (glasses) {
      cv::ellipse(picture, eye, {27, 20}, 0, 0, 360, Color(25, 25, 25), 4, cv::LINE_AA);
      cv::line(picture, {eye.x + side * 27, eye.y}, {eye.x + side * 95, eye.y - 4},
               Color(25, 25, 25), 4, cv::LINE_AA);
    }
    cv::circle(picture, {256 + side * 9, 175}, 4, scaled(skin_color, 0.55), cv::FILLED,
               cv::LINE_AA);
  }
  cv::line(picture, {250, 140}, {246, 172}, scaled(skin_color, 0.78), 3, cv::LINE_AA);
  cv::ellipse(picture, {256, 198}, {27, 6}, 0, 0, 360, Color(85, 80, 165), cv::FILLED, cv::LINE_AA);
  cv::line(picture, {229, 198}, {283, 198}, Color(50, 45, 95), 2, cv::LINE_AA);
  addField(picture, smoothNoise(picture.size(), 8, 4, 0.6, random), 10.0);
  return picture;
}

cv::Mat shoe(const Color& color, std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({128, 128}, color);
  cv::rectangle(picture, {0, 100, 128, 28}, Color(225, 225, 225), cv::FILLED);
  for (int y = 10; y < 70; y += 14) {
    cv::line(picture, {50, y}, {78, y + 9}, Color(235, 235, 235), 3, cv::LINE_AA);
  }
  addField(picture, smoothNoise(picture.size(), 6, 3, 0.6, random), 14.0);
  return picture;
}

}  // namespace hmcdyn::synthesize::paint
