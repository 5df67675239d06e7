// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "synthesize/random.hpp"

/// Procedural pictures for the surfaces of a room and of people: 8-bit BGR, drawn from a random
/// stream alone.
namespace hmcdyn::synthesize::paint {

/// A colour as blue, green, red, 0..255.
using Color = cv::Scalar;

/// Smooth noise of several octaves that repeats in both directions. float, about -1..1.
/// @param cells cells of the coarsest octave along the width.
cv::Mat smoothNoise(cv::Size size, int cells, int octaves, double persistence, Random& random);

/// Whole numbers from `low` to `high`, both included.
struct Range {
  int low = 0;
  int high = 0;
};
/// A point of random coordinates. y is drawn before x: compilers differ in the order in which they
/// evaluate two arguments, and pictures must not. For the same reason no call in these files draws
/// more than one of its arguments (what stands in braces is drawn in order).
cv::Point randomPoint(Random& random, const Range& x, const Range& y);

/// A picture of one colour.
cv::Mat plain(cv::Size size, const Color& color);
/// Adds `amplitude` (0..255) times a float field to all channels.
void addField(cv::Mat& picture, const cv::Mat& field, double amplitude);
/// Adds independent grain of a standard deviation (0..255) to every pixel.
void addGrain(cv::Mat& picture, double deviation, Random& random);

Color randomColor(Random& random, double low = 30.0, double high = 230.0);
Color scaled(const Color& color, double factor);
std::string randomWord(Random& random, int min_letters = 2, int max_letters = 9);
/// Two words, the second one drawn first.
std::string randomWords(Random& random, const Range& first, const std::string& between,
                        const Range& second);
/// Lines of words that fill a rectangle. @param line_height (px).
void writeLines(cv::Mat& picture, const cv::Rect& area, int line_height, const Color& ink,
                Random& random);

// Surfaces of the room.
cv::Mat plaster(const Color& color, double roughness, std::uint64_t seed);
cv::Mat woodPlanks(const Color& color, std::uint64_t seed);
cv::Mat woodBoard(const Color& color, std::uint64_t seed);
cv::Mat carpet(const Color& color, std::uint64_t seed);
cv::Mat concrete(const Color& color, std::uint64_t seed);
cv::Mat ceilingTiles(std::uint64_t seed);
cv::Mat fabric(const Color& color, std::uint64_t seed);
cv::Mat metal(const Color& color, std::uint64_t seed);
cv::Mat cardboard(std::uint64_t seed);
cv::Mat leaf(std::uint64_t seed);
cv::Mat windowView(std::uint64_t seed);
cv::Mat door(std::uint64_t seed);

// Printed and shown things.
cv::Mat textPage(std::uint64_t seed);
cv::Mat sciencePoster(std::uint64_t seed);
cv::Mat artPoster(std::uint64_t seed);
cv::Mat mapPoster(std::uint64_t seed);
cv::Mat photoPoster(std::uint64_t seed);
cv::Mat calendar(std::uint64_t seed);
cv::Mat whiteboard(std::uint64_t seed);
cv::Mat screen(std::uint64_t seed);
cv::Mat keyboard(std::uint64_t seed);
/// 16 spines side by side.
cv::Mat bookSpines(std::uint64_t seed);
cv::Mat bookCover(std::uint64_t seed);
cv::Mat mugPrint(std::uint64_t seed);
cv::Mat clockFace();

// People.
enum class Cloth { kChecks, kStripes, kPrint, kKnit, kCamouflage, kDenim, kPlain };
cv::Mat cloth(Cloth kind, const Color& color, const Color& second, std::uint64_t seed);
cv::Mat skin(const Color& color, std::uint64_t seed);
/// Unrolled head: the face in the middle, hair at the sides and above.
cv::Mat head(const Color& skin, const Color& hair, bool beard, bool glasses, std::uint64_t seed);
cv::Mat shoe(const Color& color, std::uint64_t seed);

}  // namespace hmcdyn::synthesize::paint
