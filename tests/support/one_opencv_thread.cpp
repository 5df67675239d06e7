// SPDX-License-Identifier: BSD-3-Clause
// Linked into every test with threads: OpenCV computes in the thread that calls it, as in
// hmcdyn_slam. ThreadSanitizer cannot follow OpenCV's own threads, which come with a library that
// is not built with it.
#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

namespace hmcdyn::test {
namespace {

class OneOpenCvThread : public testing::Environment {
 public:
  void SetUp() override { cv::setNumThreads(1); }
};

const testing::Environment* const kOneOpenCvThread =
    testing::AddGlobalTestEnvironment(new OneOpenCvThread);  // GoogleTest owns and deletes it

}  // namespace
}  // namespace hmcdyn::test
