// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/mask_folder.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "input/dataset/temporary_folder.hpp"
#include "invalid_argument.hpp"
#include "slam/detect/frame_mask.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::mentions;
using hmcdyn::test::messageOf;

const cv::Size kSize(64, 48);

class Masks : public testing::Test {
 protected:
  void put(const std::string& name, const cv::Mat& mask) const {
    ASSERT_TRUE(cv::imwrite((folder_.path() / name).string(), mask));
  }
  static cv::Mat plain(int value, int type = CV_8UC1) { return {kSize, type, cv::Scalar(value)}; }
  MaskFolder open() const { return {folder_.path(), kSize, 0.02}; }
  std::string refusal() const {
    return messageOf<std::runtime_error>([this] { open(); });
  }

  hmcdyn::test::TemporaryFolder folder_;
};

TEST_F(Masks, TheNearestInTimeIsReadWithItsValues) {
  put("10.000000.png", plain(1));
  put("10.033333.png", plain(40000, CV_16UC1));
  put("10.1.png", plain(3));
  std::ofstream(folder_.path() / "readme.txt") << "not a mask";
  const MaskFolder masks = open();
  EXPECT_EQ(masks.at(10.0).at<std::uint8_t>(5, 5), 1);
  EXPECT_EQ(masks.at(10.0166).at<std::uint8_t>(5, 5), 1)
      << "16.6 ms to the first, 16.7 to the next";
  EXPECT_EQ(masks.at(10.0168).at<std::uint16_t>(5, 5), 40000);
  EXPECT_EQ(masks.at(9.981).at<std::uint8_t>(5, 5), 1);
  EXPECT_EQ(masks.at(10.119).at<std::uint8_t>(5, 5), 3);
}

TEST_F(Masks, AMissingOneIsNamed) {
  put("10.0.png", plain(1));
  const MaskFolder masks = open();
  for (const double time : {9.97, 10.03}) {
    EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { masks.at(time); }),
                         {folder_.path().string(), "missing", "0.02 s"}));
  }
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { masks.at(10.03); }), {"10.030000.png"}));
}

TEST_F(Masks, AFolderThatIsNoneOrHasNoMaskIsNamed) {
  EXPECT_TRUE(mentions(refusal(), {folder_.path().string(), "holds no .png"}));
  EXPECT_TRUE(mentions(
      messageOf<std::runtime_error>([&] { MaskFolder(folder_.path() / "nowhere", kSize, 0.02); }),
      {"nowhere", "expected a folder of masks"}));
}

TEST_F(Masks, ANameThatIsNoTimeStampIsRefused) {
  for (const char* name : {"frame_0001.png", "10.0_mask.png", "nan.png", "1e999.png"}) {
    put(name, plain(1));
    EXPECT_TRUE(mentions(refusal(), {name, "is no time stamp", "1341846434.710184.png"})) << name;
    std::filesystem::remove(folder_.path() / name);
  }
}

TEST_F(Masks, DepthImagesAreRefused) {
  cv::Mat image = cv::Mat::zeros(kSize, CV_16UC1);
  for (int i = 0; i < 101; ++i) {
    image.at<std::uint16_t>(i / 64, i % 64) = static_cast<std::uint16_t>(5000 + 20 * i);
  }
  put("10.0.png", image);
  EXPECT_TRUE(mentions(refusal(), {"10.0.png", "101 different labels on 3 % of the image",
                                   "100 at most", "are these depth images?"}));
  image.at<std::uint16_t>(0, 0) = 0;
  put("10.0.png", image);
  EXPECT_NO_THROW(open()) << "100 things";
  image.at<std::uint16_t>(0, 0) = 1;
  put("11.0.png", image);
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { open().at(11.0); }),
                       {"11.0.png", "101 different labels"}));
}

TEST_F(Masks, TheFirstOneIsCheckedAtTheStartAndTheOthersWhenTheyAreRead) {
  put("10.0.png", cv::Mat(48, 32, CV_8UC1, cv::Scalar(1)));
  EXPECT_TRUE(mentions(refusal(), {"10.0.png", "32 x 48", "expected a mask of 64 x 48"}));
  put("10.0.png", cv::Mat(kSize, CV_8UC3, cv::Scalar(1, 2, 3)));
  EXPECT_TRUE(mentions(refusal(), {"10.0.png", "CV_8UC3", "8 or 16 bit with one channel"}));
  put("10.0.png", plain(1));
  put("11.0.png", cv::Mat(24, 64, CV_8UC1, cv::Scalar(1)));
  put("12.0.png", plain(1));
  const auto cut = folder_.path() / "12.0.png";
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) / 2);
  const MaskFolder masks = open();
  EXPECT_TRUE(
      mentions(messageOf<std::runtime_error>([&] { masks.at(11.0); }), {"11.0.png", "64 x 24"}));
  EXPECT_TRUE(
      mentions(messageOf<std::runtime_error>([&] { masks.at(12.0); }), {"12.0.png", "truncated"}));
}

TEST(FrameMasks, PiecesOfALabelAreRegionsAndCrumbsBelongToTheLargest) {
  cv::Mat labels = cv::Mat::zeros(60, 100, CV_16UC1);
  labels(cv::Rect(5, 5, 10, 10)).setTo(700);   // a person
  labels(cv::Rect(40, 5, 12, 20)).setTo(700);  // another one, under the same label
  labels(cv::Rect(70, 5, 3, 3)).setTo(700);    // a crumb: 9 px
  labels(cv::Rect(15, 5, 10, 10)).setTo(2);    // touches the first one, but is another label
  labels(cv::Rect(80, 40, 2, 2)).setTo(9);     // all that there is of its label
  const FrameMask mask = makeFrameMask(labels);
  ASSERT_EQ(mask.regions.size(), 4U);
  for (std::size_t i = 0; i < mask.regions.size(); ++i) {
    EXPECT_EQ(mask.regions[i].label, static_cast<int>(i) + 1);
    EXPECT_EQ(mask.regions[i].class_id, kPersonClassId);
  }
  const auto at = [&](int x, int y) { return mask.labels.at<int>(y, x); };
  EXPECT_EQ(at(0, 0), 0);
  EXPECT_EQ(at(20, 10), 1) << "label 2";
  EXPECT_EQ(at(80, 40), 2) << "label 9";
  EXPECT_EQ(at(10, 10), 3) << "label 700";
  EXPECT_EQ(at(45, 10), 4);
  EXPECT_EQ(at(71, 6), 4) << "the crumb, with the larger of the two";
  EXPECT_EQ(cv::countNonZero(mask.labels), 100 + 240 + 9 + 100 + 4);
  EXPECT_DOUBLE_EQ(coveredShare(mask), 453.0 / 6000.0);
}

/// A label's pieces one label at a time, by OpenCV's connected components, as they were found once:
/// 1, 2, ... in the order of labels and of first pixels, crumbs with the first of the largest.
cv::Mat numberedLabelByLabel(const cv::Mat& labels) {
  std::map<int, std::vector<std::vector<cv::Point>>> by_label;
  double largest_label = 0.0;
  cv::minMaxLoc(labels, nullptr, &largest_label);
  for (int label = 1; label <= static_cast<int>(largest_label); ++label) {
    cv::Mat pieces;
    cv::connectedComponents(labels == label, pieces, 8, CV_32S);
    std::map<int, std::size_t> place;
    auto& of_label = by_label[label];
    for (int row = 0; row < labels.rows; ++row) {
      for (int column = 0; column < labels.cols; ++column) {
        if (const int piece = pieces.at<int>(row, column); piece != 0) {
          const auto [at, is_new] = place.emplace(piece, of_label.size());
          if (is_new) {
            of_label.emplace_back();
          }
          of_label[at->second].emplace_back(column, row);
        }
      }
    }
  }
  cv::Mat numbered = cv::Mat::zeros(labels.size(), CV_32SC1);
  int next = 1;
  for (const auto& [label, pieces] : by_label) {
    const auto largest = std::max_element(pieces.begin(), pieces.end(),
                                          [](auto& a, auto& b) { return a.size() < b.size(); });
    int of_largest = 0;
    for (auto piece = pieces.begin(); piece != pieces.end(); ++piece) {
      const bool is_region = piece == largest || piece->size() >= 64;
      of_largest = piece == largest ? next : of_largest;
      for (const cv::Point& pixel : *piece) {
        numbered.at<int>(pixel) = is_region ? next : -1;
      }
      next += is_region ? 1 : 0;
    }
    numbered.setTo(of_largest, numbered == -1);
  }
  return numbered;
}

TEST(FrameMasks, InOnePassTheRegionsAreThoseOfOneLabelAfterTheOther) {
  cv::RNG random(1);
  for (int round = 0; round < 40; ++round) {
    cv::Mat labels = cv::Mat::zeros(60, 90, round % 2 == 0 ? CV_8UC1 : CV_16UC1);
    for (int i = 0; i < 30; ++i) {
      const cv::Point centre(random.uniform(0, 90), random.uniform(0, 60));
      const cv::Size axes(random.uniform(1, 14), random.uniform(1, 14));
      cv::ellipse(labels, centre, axes, random.uniform(0, 180), 0, 360,
                  cv::Scalar(random.uniform(0, 6)), cv::FILLED);
    }
    if (round % 4 == 3) {  // crumbs and borders everywhere
      for (int i = 0; i < 400; ++i) {
        labels(cv::Rect(random.uniform(0, 90), random.uniform(0, 60), 1, 1))
            .setTo(random.uniform(0, 6));
      }
    }
    const FrameMask mask = makeFrameMask(labels);
    const cv::Mat expected = numberedLabelByLabel(labels);
    EXPECT_EQ(cv::countNonZero(mask.labels != expected), 0) << "round " << round;
    double most = 0.0;
    cv::minMaxLoc(expected, nullptr, &most);
    EXPECT_EQ(mask.regions.size(), static_cast<std::size_t>(most));
  }
}

// Label by label this took four seconds an image.
TEST(FrameMasks, AsManyLabelsAsThereAreAreFoundAtOnce) {
  cv::Mat labels(480, 640, CV_16UC1);
  for (int row = 0; row < labels.rows; ++row) {
    for (int column = 0; column < labels.cols; ++column) {
      labels.at<std::uint16_t>(row, column) =
          static_cast<std::uint16_t>((row * labels.cols + column) % 65536);
    }
  }
  const std::int64_t begin = cv::getTickCount();
  const FrameMask mask = makeFrameMask(labels, 4);
  const double seconds = static_cast<double>(cv::getTickCount() - begin) / cv::getTickFrequency();
  EXPECT_EQ(mask.regions.size(), 65535U);
  EXPECT_LT(seconds, 2.0);  // 0.1 s; sanitizers and other programs take their time
}

TEST(FrameMasks, RegionsGrowByTheMarginAndNotIntoEachOther) {
  cv::Mat labels = cv::Mat::zeros(40, 60, CV_8UC1);
  labels(cv::Rect(10, 10, 10, 10)).setTo(1);
  labels(cv::Rect(22, 10, 10, 10)).setTo(2);
  const FrameMask mask = makeFrameMask(labels, 3);
  const auto at = [&](int x, int y) { return mask.labels.at<int>(y, x); };
  EXPECT_EQ(at(7, 7), 1);
  EXPECT_EQ(at(6, 10), 0);
  EXPECT_EQ(at(19, 12), 1) << "its own pixels stay";
  EXPECT_EQ(at(20, 12), 2) << "between the two";
  EXPECT_EQ(at(34, 22), 2);
  EXPECT_EQ(at(35, 22), 0);
  EXPECT_EQ(cv::countNonZero(mask.labels), 28 * 16);
}

TEST(FrameMasks, NothingMovesWhereAllIsBackground) {
  const FrameMask mask = makeFrameMask(cv::Mat::zeros(kSize, CV_8UC1));
  EXPECT_FALSE(mask.empty());
  EXPECT_TRUE(mask.regions.empty());
  EXPECT_EQ(coveredShare(mask), 0.0);
  EXPECT_EQ(coveredShare(FrameMask{}), 0.0);
}

TEST(FrameMasks, OtherImagesAreRefused) {
  EXPECT_TRUE(mentions(hmcdyn::test::invalidArgumentOf([] { makeFrameMask(cv::Mat()); }),
                       {"labels is empty", "CV_8UC1 or CV_16UC1"}));
  EXPECT_TRUE(mentions(hmcdyn::test::invalidArgumentOf(
                           [] { makeFrameMask(cv::Mat(kSize, CV_32FC1, cv::Scalar(1))); }),
                       {"CV_32FC1"}));
  EXPECT_TRUE(mentions(
      hmcdyn::test::invalidArgumentOf([] { makeFrameMask(cv::Mat::zeros(kSize, CV_8UC1), -1); }),
      {"margin is -1 px"}));
}

}  // namespace
}  // namespace hmcdyn::slam
