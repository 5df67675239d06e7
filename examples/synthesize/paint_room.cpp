// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "synthesize/paint.hpp"

namespace hmcdyn::synthesize::paint {
namespace {

/// Thin marks as use leaves them: scratches, scuffs, spots.
void addScuffs(cv::Mat& picture, int count, double strength, Random& random) {
  for (int i = 0; i < count; ++i) {
    const cv::Point from = randomPoint(random, {0, picture.cols - 1}, {0, picture.rows - 1});
    const cv::Vec3b base = picture.at<cv::Vec3b>(from);
    const double change = random.uniform(-strength, 0.6 * strength);
    const Color color(base[0] + change, base[1] + change, base[2] + change);
    if (random.chance(0.5)) {
      const cv::Point to = from + randomPoint(random, {-60, 60}, {-25, 25});
      cv::line(picture, from, to, color, 1, cv::LINE_AA);
    } else {
      const double angle = random.uniform(0.0, 180.0);
      cv::ellipse(picture, from, {random.integer(1, 6), random.integer(1, 4)}, angle, 0.0, 360.0,
                  color, cv::FILLED, cv::LINE_AA);
    }
  }
}

/// Grain of wood along the picture's width inside `area`.
void addWoodGrain(cv::Mat& picture, const cv::Rect& area, double strength, Random& random) {
  cv::Mat part = picture(area);
  const double frequency = random.uniform(0.05, 0.12);
  const double phase = random.uniform(0.0, 100.0);
  const cv::Mat bend = smoothNoise(part.size(), std::max(2, area.width / 160), 2, 0.5, random);
  cv::Mat fibres(part.rows, std::max(1, part.cols / 24), CV_32FC1);
  for (int y = 0; y < fibres.rows; ++y) {
    for (int x = 0; x < fibres.cols; ++x) {
      fibres.at<float>(y, x) = static_cast<float>(random.uniform(-1.0, 1.0));
    }
  }
  cv::resize(fibres, fibres, part.size(), 0.0, 0.0, cv::INTER_CUBIC);
  cv::Mat field(part.size(), CV_32FC1);
  for (int y = 0; y < part.rows; ++y) {
    for (int x = 0; x < part.cols; ++x) {
      const double rings = std::sin(
          6.2832 * (frequency * y + 1.6 * static_cast<double>(bend.at<float>(y, x))) + phase);
      field.at<float>(y, x) =
          static_cast<float>(0.6 * rings * std::abs(rings)) + 0.5f * fibres.at<float>(y, x);
    }
  }
  addField(part, field, strength);
  for (int knot = 0; knot < area.width * area.height / 90000 + (random.chance(0.4) ? 1 : 0);
       ++knot) {
    const cv::Point centre =
        randomPoint(random, {10, std::max(11, part.cols - 10)}, {3, std::max(4, part.rows - 3)});
    const int size = random.integer(3, 8);
    cv::ellipse(part, centre, {2 * size, size}, 0.0, 0.0, 360.0, Color(40, 70, 105), 1,
                cv::LINE_AA);
    cv::ellipse(part, centre, {size, size / 2 + 1}, 0.0, 0.0, 360.0, Color(30, 50, 80), cv::FILLED,
                cv::LINE_AA);
  }
}

}  // namespace

cv::Mat plaster(const Color& color, double roughness, std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({1024, 1024}, color);
  addField(picture, smoothNoise(picture.size(), 4, 3, 0.6, random), 7.0 * roughness);
  addField(picture, smoothNoise(picture.size(), 128, 2, 0.7, random), 7.0 * roughness);
  if (roughness > 0.3) {
    addScuffs(picture, static_cast<int>(60 * roughness), 26.0, random);
  }
  return picture;
}

cv::Mat woodPlanks(const Color& color, std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({1024, 1024}, color);
  constexpr int kPlank = 64;
  for (int y = 0; y < picture.rows; y += kPlank) {
    int x = -random.integer(0, 300);
    while (x < picture.cols) {
      const int length = random.integer(260, 520);
      const cv::Rect area = cv::Rect(x, y, length, kPlank) & cv::Rect({0, 0}, picture.size());
      if (area.width > 8) {
        picture(area).setTo(scaled(color, random.uniform(0.75, 1.15)));
        addWoodGrain(picture, area, 16.0, random);
        cv::line(picture, {x, y}, {x, y + kPlank}, scaled(color, 0.4), 2);
      }
      x += length;
    }
    cv::line(picture, {0, y}, {picture.cols, y}, scaled(color, 0.45), 2);
  }
  addScuffs(picture, 180, 45.0, random);
  return picture;
}

cv::Mat woodBoard(const Color& color, std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({1024, 512}, color);
  addWoodGrain(picture, {0, 0, picture.cols, picture.rows}, 12.0, random);
  addScuffs(picture, 70, 30.0, random);
  return picture;
}

cv::Mat carpet(const Color& color, std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({1024, 1024}, color);
  addField(picture, smoothNoise(picture.size(), 6, 3, 0.6, random), 12.0);
  addField(picture, smoothNoise(picture.size(), 200, 2, 0.9, random), 24.0);
  addGrain(picture, 12.0, random);
  addScuffs(picture, 260, 70.0, random);
  // Tiles of half a metre, each laid a little darker or brighter.
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      cv::Mat tile = picture(cv::Rect(x * 256, y * 256, 256, 256));
      tile.convertTo(tile, -1, random.uniform(0.88, 1.12));
      cv::rectangle(picture, cv::Rect(x * 256, y * 256, 256, 256), scaled(color, 0.7), 1);
    }
  }
  return picture;
}

cv::Mat concrete(const Color& color, std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({1024, 1024}, color);
  addField(picture, smoothNoise(picture.size(), 5, 6, 0.7, random), 26.0);
  addGrain(picture, 5.0, random);
  addScuffs(picture, 300, 55.0, random);
  for (int i = 0; i < 9; ++i) {  // cracks
    cv::Point p = randomPoint(random, {0, 1023}, {0, 1023});
    for (int step = 0; step < 30; ++step) {
      const cv::Point q = p + randomPoint(random, {-14, 16}, {-12, 14});
      cv::line(picture, p, q, scaled(color, 0.55), 1, cv::LINE_AA);
      p = q;
    }
  }
  for (int i = 0; i < 7; ++i) {  // tape marks
    const cv::Point p = randomPoint(random, {50, 970}, {50, 970});
    const Color tape = random.chance(0.5) ? Color(60, 200, 230) : Color(200, 120, 40);
    cv::line(picture, {p.x - 18, p.y}, {p.x + 18, p.y}, tape, 7);
    if (random.chance(0.6)) {
      cv::line(picture, {p.x, p.y - 18}, {p.x, p.y + 18}, tape, 7);
    }
  }
  return picture;
}

cv::Mat ceilingTiles(std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({512, 512}, {205, 210, 212});
  for (int i = 0; i < 1500; ++i) {
    const int radius = random.integer(0, 1);
    cv::circle(picture, {random.integer(0, 511), random.integer(0, 511)}, radius,
               Color(165, 168, 170), cv::FILLED);
  }
  for (int i = 0; i < 512; i += 256) {
    cv::line(picture, {i, 0}, {i, 511}, Color(235, 235, 235), 6);
    cv::line(picture, {0, i}, {511, i}, Color(235, 235, 235), 6);
    cv::line(picture, {i + 4, 0}, {i + 4, 511}, Color(150, 150, 150), 1);
    cv::line(picture, {0, i + 4}, {511, i + 4}, Color(150, 150, 150), 1);
  }
  return picture;
}

cv::Mat fabric(const Color& color, std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({512, 512}, color);
  for (int y = 0; y < picture.rows; ++y) {
    auto* row = picture.ptr<cv::Vec3b>(y);
    for (int x = 0; x < picture.cols; ++x) {
      const double weave = ((x / 3 + y / 3) % 2 == 0 ? 8.0 : -8.0);
      for (int c = 0; c < 3; ++c) {
        row[x][c] = cv::saturate_cast<std::uint8_t>(row[x][c] + weave);
      }
    }
  }
  addField(picture, smoothNoise(picture.size(), 5, 4, 0.7, random), 16.0);
  addGrain(picture, 6.0, random);
  return picture;
}

cv::Mat metal(const Color& color, std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({256, 256}, color);
  addField(picture, smoothNoise(picture.size(), 3, 3, 0.5, random), 8.0);
  addScuffs(picture, 14, 25.0, random);
  return picture;
}

cv::Mat cardboard(std::uint64_t seed) {
  Random random(seed);
  const Color brown = scaled({95, 140, 175}, random.uniform(0.85, 1.1));
  cv::Mat picture = plain({512, 512}, brown);
  addField(picture, smoothNoise(picture.size(), 4, 5, 0.6, random), 12.0);
  cv::rectangle(picture, {0, 220, 512, 60}, scaled({120, 175, 205}, random.uniform(0.85, 1.05)),
                cv::FILLED);
  const int x = random.integer(30, 240);
  const int y = random.integer(300, 350);
  cv::rectangle(picture, {x, y, 190, 120}, Color(235, 240, 240), cv::FILLED);
  writeLines(picture, {x + 8, y + 6, 174, 60}, 18, Color(30, 30, 30), random);
  for (int bar = 0; bar < 160;) {
    const int width = random.integer(1, 5);
    cv::rectangle(picture, {x + 12 + bar, y + 74, width, 36}, Color(20, 20, 20), cv::FILLED);
    bar += width + random.integer(2, 6);
  }
  const std::string brand = randomWord(random, 4, 7);
  cv::putText(picture, brand, {40, 130}, cv::FONT_HERSHEY_DUPLEX, 3.0, scaled(brown, 0.4), 7,
              cv::LINE_AA);
  writeLines(picture, {50, 150, 300, 60}, 26, scaled(brown, 0.45), random);
  cv::arrowedLine(picture, {440, 200}, {440, 70}, scaled(brown, 0.4), 10, cv::LINE_AA, 0, 0.35);
  addScuffs(picture, 60, 40.0, random);
  return picture;
}

cv::Mat leaf(std::uint64_t seed) {
  Random random(seed);
  const Color green(40, random.uniform(95, 145), 60);
  cv::Mat picture = plain({128, 128}, green);
  addField(picture, smoothNoise(picture.size(), 4, 3, 0.6, random), 25.0);
  for (int x = 4; x < 128; x += 13) {
    cv::line(picture, {x, 0}, {x + 20, 127}, scaled(green, random.uniform(0.6, 1.5)), 2,
             cv::LINE_AA);
  }
  return picture;
}

cv::Mat windowView(std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture(cv::Size(512, 512), CV_8UC3);
  for (int y = 0; y < 512; ++y) {
    // NOLINTNEXTLINE(bugprone-integer-division): grey levels are whole
    picture.row(y).setTo(Color(250 - y / 8, 235 - y / 10, 205 - y / 9));
  }
  addField(picture, smoothNoise(picture.size(), 3, 5, 0.6, random), 14.0);
  for (int x = -20; x < 512;) {  // houses
    const int width = random.integer(70, 150);
    const int top = random.integer(150, 300);
    const Color wall = scaled(randomColor(random, 110, 210), 1.0);
    cv::rectangle(picture, cv::Rect(x, top, width, 512 - top), wall, cv::FILLED);
    for (int wy = top + 12; wy < 500; wy += 30) {
      for (int wx = x + 8; wx + 14 < x + width; wx += 24) {
        cv::rectangle(picture, cv::Rect(wx, wy, 13, 18), scaled(wall, random.uniform(0.25, 0.6)),
                      cv::FILLED);
      }
    }
    x += width + random.integer(0, 40);
  }
  for (int i = 0; i < 900; ++i) {  // trees
    const int cluster = random.integer(0, 4) * 120 + 20;
    const double red = random.uniform(40, 90);
    const double green = random.uniform(70, 150);
    const double blue = random.uniform(30, 80);
    const int radius = random.integer(3, 9);
    cv::circle(picture,
               {cluster + static_cast<int>(28.0 * random.normal()),
                410 + static_cast<int>(40.0 * random.normal())},
               radius, Color(blue, green, red), cv::FILLED, cv::LINE_AA);
  }
  return picture;
}

cv::Mat door(std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = woodBoard({120, 165, 195}, seed);
  cv::rotate(picture, picture, cv::ROTATE_90_CLOCKWISE);
  cv::rectangle(picture, {4, 4, picture.cols - 8, picture.rows - 8}, Color(70, 90, 105), 5);
  cv::rectangle(picture, {70, 80, picture.cols - 140, 330}, Color(85, 120, 145), 6);
  cv::rectangle(picture, {70, 600, picture.cols - 140, 330}, Color(85, 120, 145), 6);
  cv::rectangle(picture, {150, 200, 220, 150}, Color(240, 240, 235), cv::FILLED);
  writeLines(picture, {165, 210, 190, 130}, 24, Color(40, 40, 40), random);
  cv::rectangle(picture, {430, 490, 40, 90}, Color(180, 185, 185), cv::FILLED);
  cv::line(picture, {450, 530}, {385, 530}, Color(95, 95, 95), 14, cv::LINE_AA);
  return picture;
}

}  // namespace hmcdyn::synthesize::paint
