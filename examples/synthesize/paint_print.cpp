// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "synthesize/paint.hpp"

namespace hmcdyn::synthesize::paint {
namespace {

/// A framed diagram: curves, bars or scattered points.
void drawPlot(cv::Mat& picture, const cv::Rect& area, Random& random) {
  cv::rectangle(picture, area, Color(252, 252, 252), cv::FILLED);
  cv::rectangle(picture, area, Color(60, 60, 60), 2);
  const int kind = random.integer(0, 2);
  for (int series = 0; series < 3; ++series) {
    const Color color = randomColor(random, 20, 200);
    cv::Point previous(area.x, area.y + random.integer(area.height / 4, area.height * 3 / 4));
    for (int x = area.x + 8; x < area.x + area.width - 4; x += 12) {
      const int y =
          std::clamp(previous.y + random.integer(-14, 14), area.y + 4, area.y + area.height - 4);
      if (kind == 0) {
        cv::line(picture, previous, {x, y}, color, 2, cv::LINE_AA);
      } else if (kind == 1) {
        cv::rectangle(picture, cv::Point(x + 3 * series, y),
                      cv::Point(x + 3 * series + 3, area.y + area.height - 2), color, cv::FILLED);
      } else {
        cv::circle(picture, {x, y}, 3, color, cv::FILLED, cv::LINE_AA);
      }
      previous = {x, y};
    }
  }
}

void drawWindow(cv::Mat& picture, const cv::Rect& area, bool dark, Random& random) {
  cv::rectangle(picture, area, dark ? Color(38, 32, 30) : Color(245, 245, 245), cv::FILLED);
  cv::rectangle(picture, {area.x, area.y, area.width, 16}, Color(150, 110, 70), cv::FILLED);
  cv::putText(picture, randomWord(random, 6, 12), {area.x + 6, area.y + 12},
              cv::FONT_HERSHEY_SIMPLEX, 0.4, Color(255, 255, 255), 1, cv::LINE_AA);
  for (int y = area.y + 30; y < area.y + area.height - 6; y += 12) {
    int x = area.x + 8 + 14 * random.integer(0, 3);
    while (x < area.x + area.width - 60 && random.chance(0.85)) {
      const std::string word = randomWord(random);
      const Color ink = dark ? randomColor(random, 110, 255) : randomColor(random, 0, 120);
      cv::putText(picture, word, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.35, ink, 1, cv::LINE_AA);
      x += static_cast<int>(word.size()) * 7 + 8;
    }
  }
}

}  // namespace

cv::Mat textPage(std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({362, 512}, scaled({240, 246, 248}, random.uniform(0.92, 1.02)));
  cv::putText(picture, randomWord(random, 8, 13), {30, 50}, cv::FONT_HERSHEY_DUPLEX, 1.1,
              Color(30, 30, 30), 2, cv::LINE_AA);
  writeLines(picture, {30, 65, 300, random.integer(120, 200)}, 15, Color(40, 40, 40), random);
  drawPlot(picture, {50, 290, 250, 110}, random);
  writeLines(picture, {30, 410, 300, 80}, 15, Color(40, 40, 40), random);
  return picture;
}

cv::Mat sciencePoster(std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({724, 1024}, Color(245, 245, 240));
  const Color theme = randomColor(random, 40, 190);
  cv::rectangle(picture, {0, 0, 724, 130}, theme, cv::FILLED);
  cv::putText(picture, randomWords(random, {7, 9}, " ", {5, 8}), {40, 65}, cv::FONT_HERSHEY_DUPLEX,
              1.7, Color(255, 255, 255), 3, cv::LINE_AA);
  cv::putText(picture, randomWords(random, {9, 12}, ", ", {7, 10}), {44, 110},
              cv::FONT_HERSHEY_SIMPLEX, 0.9, Color(240, 240, 240), 2, cv::LINE_AA);
  for (int column = 0; column < 2; ++column) {
    const int x = 30 + column * 345;
    for (int y = 150; y < 960;) {
      const int height = random.integer(120, 240);
      cv::rectangle(picture, cv::Rect(x, y, 320, 30), scaled(theme, 1.2), cv::FILLED);
      cv::putText(picture, randomWord(random, 6, 12), {x + 10, y + 23}, cv::FONT_HERSHEY_DUPLEX,
                  0.8, Color(255, 255, 255), 2, cv::LINE_AA);
      const cv::Rect body(x, y + 38, 320, std::min(height, 990 - y - 38));
      if (random.chance(0.45)) {
        drawPlot(picture, body, random);
      } else {
        writeLines(picture, body, 21, Color(35, 35, 35), random);
      }
      y += height + 52;
    }
  }
  return picture;
}

cv::Mat artPoster(std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({512, 724}, randomColor(random, 60, 240));
  for (int i = 0; i < 42; ++i) {
    const Color color = randomColor(random, 10, 250);
    const cv::Point p = randomPoint(random, {0, 511}, {0, 723});
    const int size = random.integer(14, 90);
    switch (random.integer(0, 3)) {
      case 0:
        cv::circle(picture, p, size, color, random.chance(0.5) ? cv::FILLED : 8, cv::LINE_AA);
        break;
      case 1:
        cv::rectangle(picture, cv::Rect(p.x, p.y, size, random.integer(10, 120)), color,
                      cv::FILLED);
        break;
      case 2: {
        std::vector<cv::Point> corners;
        corners.reserve(6);
        for (int k = 0; k < random.integer(3, 6); ++k) {
          corners.push_back(p + randomPoint(random, {-size, size}, {-size, size}));
        }
        cv::fillPoly(picture, std::vector<std::vector<cv::Point>>{corners}, color, cv::LINE_AA);
        break;
      }
      default: {
        const int thickness = random.integer(2, 12);
        cv::line(picture, p, {p.x + random.integer(-160, 160), p.y + random.integer(-160, 160)},
                 color, thickness, cv::LINE_AA);
      }
    }
  }
  cv::rectangle(picture, {0, 0, 512, 724}, Color(240, 240, 240), 22);
  cv::putText(picture, randomWord(random, 5, 8), {40, 660}, cv::FONT_HERSHEY_TRIPLEX, 2.6,
              Color(250, 250, 250), 7, cv::LINE_AA);
  return picture;
}

cv::Mat mapPoster(std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture(cv::Size(1024, 724), CV_8UC3);
  const cv::Mat height = smoothNoise(picture.size(), 5, 5, 0.55, random);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const float h = height.at<float>(y, x);
      const Color color = h < -0.15f ? Color(200, 170, 120)
                                     : (h < 0.25f ? Color(150, 205, 165) : Color(140, 180, 215));
      const bool contour = std::abs(std::fmod(static_cast<double>(h) + 4.0, 0.16) - 0.08) < 0.012;
      for (int c = 0; c < 3; ++c) {
        picture.at<cv::Vec3b>(y, x)[c] =
            cv::saturate_cast<std::uint8_t>(color[c] * (contour ? 0.62 : 1.0));
      }
    }
  }
  for (int road = 0; road < 16; ++road) {
    cv::Point p = randomPoint(random, {0, 1023}, {0, 723});
    const double heading = random.uniform(0.0, 6.28);
    for (int step = 0; step < 18; ++step) {
      const double turn = heading + 0.5 * random.normal();
      const cv::Point q(p.x + static_cast<int>(34 * std::cos(turn)),
                        p.y + static_cast<int>(34 * std::sin(turn)));
      cv::line(picture, p, q, Color(60, 90, 200), random.chance(0.5) ? 2 : 3, cv::LINE_AA);
      p = q;
    }
  }
  for (int town = 0; town < 46; ++town) {
    const cv::Point p = randomPoint(random, {20, 900}, {20, 700});
    cv::circle(picture, p, random.integer(3, 7), Color(30, 30, 30), cv::FILLED, cv::LINE_AA);
    const double size = random.uniform(0.5, 0.9);
    cv::putText(picture, randomWord(random, 4, 9), {p.x + 9, p.y + 5}, cv::FONT_HERSHEY_SIMPLEX,
                size, Color(20, 20, 20), 2, cv::LINE_AA);
  }
  cv::rectangle(picture, {0, 0, 1024, 724}, Color(60, 60, 60), 10);
  return picture;
}

cv::Mat photoPoster(std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = windowView(seed + 1);
  cv::resize(picture, picture, {640, 480});
  addField(picture, smoothNoise(picture.size(), 8, 5, 0.7, random), 45.0);
  for (int i = 0; i < 26; ++i) {
    const Color color = randomColor(random, 10, 240);
    const double angle = random.uniform(0, 180);
    const cv::Size axes{random.integer(5, 34), random.integer(5, 34)};
    cv::ellipse(picture, {random.integer(0, 639), random.integer(180, 470)}, axes, angle, 0, 360,
                color, cv::FILLED, cv::LINE_AA);
  }
  cv::rectangle(picture, {0, 0, 640, 480}, Color(35, 35, 35), 14);
  return picture;
}

cv::Mat calendar(std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({512, 724}, Color(248, 248, 248));
  photoPoster(seed + 5)(cv::Rect(0, 0, 512, 300)).copyTo(picture(cv::Rect(0, 0, 512, 300)));
  for (int day = 0; day < 35; ++day) {
    const cv::Rect cell(20 + (day % 7) * 68, 330 + (day / 7) * 74, 64, 70);
    cv::rectangle(picture, cell, Color(120, 120, 120), 1);
    cv::putText(picture, std::to_string(day % 31 + 1), {cell.x + 6, cell.y + 40},
                cv::FONT_HERSHEY_DUPLEX, 1.1, day % 7 > 4 ? Color(40, 40, 200) : Color(30, 30, 30),
                2, cv::LINE_AA);
    if (random.chance(0.25)) {
      cv::circle(picture, {cell.x + 32, cell.y + 30}, 26, randomColor(random), 3, cv::LINE_AA);
    }
  }
  return picture;
}

cv::Mat whiteboard(std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({1024, 640}, Color(238, 238, 234));
  addField(picture, smoothNoise(picture.size(), 4, 3, 0.6, random), 7.0);
  const std::array<Color, 4> pens{Color(30, 30, 30), Color(180, 70, 20), Color(40, 40, 190),
                                  Color(50, 130, 30)};
  for (int block = 0; block < 15; ++block) {
    const Color& pen = pens[static_cast<std::size_t>(random.integer(0, 3))];
    const cv::Rect area(30 + (block % 5) * 198, 30 + (block / 5) * 205, 175, 180);
    switch (random.integer(0, 3)) {
      case 0:
        for (int y = area.y + 30; y < area.y + area.height; y += 38) {
          cv::putText(picture, randomWord(random, 3, 8), {area.x, y},
                      cv::FONT_HERSHEY_SCRIPT_SIMPLEX, 1.2, pen, 2, cv::LINE_AA);
        }
        break;
      case 1:
        cv::arrowedLine(picture, {area.x, area.y + 160}, {area.x, area.y + 10}, pen, 2);
        cv::arrowedLine(picture, {area.x, area.y + 160}, {area.x + 170, area.y + 160}, pen, 2);
        for (int x = 5; x < 160; x += 5) {
          cv::line(picture, {area.x + x, area.y + 90 + static_cast<int>(50 * std::sin(x * 0.06))},
                   {area.x + x + 5, area.y + 90 + static_cast<int>(50 * std::sin(x * 0.06 + 0.3))},
                   pen, 3, cv::LINE_AA);
        }
        break;
      case 2:
        for (int node = 0; node < 4; ++node) {
          const cv::Point p(area.x + 30 + random.integer(0, 110), area.y + 20 + node * 45);
          cv::rectangle(picture, cv::Rect(p.x - 30, p.y - 14, 60, 28), pen, 2, cv::LINE_AA);
          cv::putText(picture, randomWord(random, 2, 3), {p.x - 20, p.y + 8},
                      cv::FONT_HERSHEY_SIMPLEX, 0.7, pen, 2, cv::LINE_AA);
          cv::line(picture, {p.x, p.y + 14}, {area.x + 85, p.y + 34}, pen, 2, cv::LINE_AA);
        }
        break;
      default:
        for (int y = area.y + 30; y < area.y + area.height; y += 46) {
          cv::putText(picture, randomWords(random, {1, 2}, " = ", {1, 3}) + "/2", {area.x, y},
                      cv::FONT_HERSHEY_COMPLEX, 0.9, pen, 2, cv::LINE_AA);
        }
    }
  }
  cv::rectangle(picture, {0, 0, 1024, 640}, Color(150, 150, 150), 14);
  return picture;
}

cv::Mat screen(std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture(cv::Size(640, 400), CV_8UC3);
  for (int y = 0; y < 400; ++y) {
    // NOLINTNEXTLINE(bugprone-integer-division): grey levels are whole
    picture.row(y).setTo(Color(150 - y / 5, 90 + y / 8, 40 + y / 8));
  }
  const bool dark = random.chance(0.5);
  drawWindow(picture, {random.integer(20, 60), random.integer(20, 40), 360, 300}, dark, random);
  drawWindow(picture, {random.integer(330, 370), random.integer(60, 110), 250, 240}, !dark, random);
  drawPlot(picture, {440, 230, 180, 120}, random);
  cv::rectangle(picture, {0, 378, 640, 22}, Color(50, 40, 40), cv::FILLED);
  for (int x = 8; x < 300; x += 34) {
    cv::rectangle(picture, cv::Rect(x, 381, 24, 16), randomColor(random, 90, 255), cv::FILLED);
  }
  for (int y = 12; y < 340; y += 52) {
    cv::rectangle(picture, cv::Rect(4, y, 16, 26), randomColor(random, 60, 255), cv::FILLED);
  }
  return picture;
}

cv::Mat keyboard(std::uint64_t seed) {
  Random random(seed);
  const bool dark = random.chance(0.6);
  cv::Mat picture = plain({512, 176}, dark ? Color(28, 28, 28) : Color(190, 195, 200));
  const Color key = dark ? Color(60, 58, 56) : Color(232, 235, 238);
  const Color ink = dark ? Color(225, 225, 225) : Color(50, 50, 50);
  for (int row = 0; row < 6; ++row) {
    for (int x = 8 + row * 3; x < 490;) {
      int width = 26;
      if (row == 5 && x > 100 && x < 140) {
        width = 150;
      } else if (random.chance(0.1)) {
        width = 42;
      }
      if (x + width > 506 || (x < 392 && x + width > 384)) {
        x += 16;
        continue;
      }
      cv::rectangle(picture, cv::Rect(x, 8 + row * 28, width - 4, 23), key, cv::FILLED);
      cv::putText(picture, randomWord(random, 1, 1), {x + 5, 24 + row * 28},
                  cv::FONT_HERSHEY_SIMPLEX, 0.45, ink, 1, cv::LINE_AA);
      x += width;
    }
  }
  return picture;
}

cv::Mat bookSpines(std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture(cv::Size(1024, 512), CV_8UC3);
  for (int book = 0; book < 16; ++book) {
    const Color color = randomColor(random, 25, 225);
    cv::Mat upright = plain({512, 64}, color);  // drawn lying, then turned
    const Color ink = color[1] > 130 ? Color(25, 25, 25) : Color(235, 240, 240);
    for (int band = 0; band < random.integer(1, 3); ++band) {
      const Color stripe = randomColor(random, 20, 240);
      const int width = random.integer(4, 26);
      cv::rectangle(upright, cv::Rect(random.integer(5, 480), 0, width, 64), stripe, cv::FILLED);
    }
    const double size = random.uniform(0.9, 1.4);
    const int left = random.integer(20, 60);
    cv::putText(upright, randomWords(random, {4, 8}, " ", {4, 8}), {left, 44},
                cv::FONT_HERSHEY_DUPLEX, size, ink, 2, cv::LINE_AA);
    cv::line(upright, {0, 1}, {511, 1}, scaled(color, 0.5), 3);
    cv::line(upright, {0, 62}, {511, 62}, scaled(color, 0.5), 3);
    cv::rotate(upright, upright, cv::ROTATE_90_CLOCKWISE);
    upright.copyTo(picture(cv::Rect(book * 64, 0, 64, 512)));
  }
  return picture;
}

cv::Mat bookCover(std::uint64_t seed) {
  Random random(seed);
  const Color color = randomColor(random, 40, 220);
  cv::Mat picture = plain({256, 362}, color);
  addField(picture, smoothNoise(picture.size(), 4, 4, 0.6, random), 16.0);
  for (int i = 0; i < 9; ++i) {
    const int thickness = random.chance(0.5) ? 4 : cv::FILLED;
    const Color ink = randomColor(random);
    const int radius = random.integer(8, 46);
    cv::circle(picture, {random.integer(20, 236), random.integer(120, 300)}, radius, ink, thickness,
               cv::LINE_AA);
  }
  cv::rectangle(picture, {14, 22, 228, 84}, scaled(color, 0.45), cv::FILLED);
  cv::putText(picture, randomWord(random, 5, 7), {26, 60}, cv::FONT_HERSHEY_DUPLEX, 1.3,
              Color(245, 245, 245), 2, cv::LINE_AA);
  cv::putText(picture, randomWord(random, 7, 10), {26, 92}, cv::FONT_HERSHEY_DUPLEX, 0.9,
              Color(235, 235, 235), 2, cv::LINE_AA);
  return picture;
}

cv::Mat mugPrint(std::uint64_t seed) {
  Random random(seed);
  cv::Mat picture = plain({256, 128}, randomColor(random, 80, 240));
  for (int x = 20; x < 256; x += 60) {
    const Color color = randomColor(random);
    const int radius = random.integer(10, 24);
    cv::circle(picture, {x, random.integer(40, 90)}, radius, color, cv::FILLED, cv::LINE_AA);
  }
  const Color ink = randomColor(random, 0, 80);
  cv::putText(picture, randomWord(random, 4, 6), {80, 80}, cv::FONT_HERSHEY_DUPLEX, 1.3, ink, 3,
              cv::LINE_AA);
  cv::rectangle(picture, {0, 0, 256, 10}, Color(60, 50, 50), cv::FILLED);
  return picture;
}

cv::Mat clockFace() {
  cv::Mat picture = plain({256, 256}, Color(245, 245, 245));
  const cv::Point centre(128, 128);
  cv::circle(picture, centre, 118, Color(30, 30, 30), 12, cv::LINE_AA);
  for (int hour = 0; hour < 12; ++hour) {
    const double angle = hour * 0.5236;
    cv::line(picture,
             {128 + static_cast<int>(90 * std::sin(angle)),
              128 - static_cast<int>(90 * std::cos(angle))},
             {128 + static_cast<int>(108 * std::sin(angle)),
              128 - static_cast<int>(108 * std::cos(angle))},
             Color(20, 20, 20), 7, cv::LINE_AA);
  }
  cv::line(picture, centre, {128, 50}, Color(20, 20, 20), 6, cv::LINE_AA);
  cv::line(picture, centre, {180, 150}, Color(20, 20, 20), 9, cv::LINE_AA);
  return picture;
}

}  // namespace hmcdyn::synthesize::paint
