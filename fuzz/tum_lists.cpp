// SPDX-License-Identifier: BSD-3-Clause
// A TUM folder's lists. The input is associations.txt, or, where it has a line "%", rgb.txt before
// and depth.txt behind it. The images "a" and "b" are there.
#include <stdexcept>
#include <string>
#include <vector>

#include "fuzz_input.hpp"
#include "slam/input/dataset/tum_dataset.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const hmcdyn::fuzz::ScratchFolder folder;
  static const bool images = [] {
    folder.write("a", "");
    folder.write("b", "");
    return true;
  }();
  const std::string text(bytes, bytes + size);
  const std::size_t cut = text.find("\n%\n");
  std::filesystem::remove(folder.path() / "associations.txt");
  if (cut == std::string::npos) {
    folder.write("associations.txt", text);
  } else {
    folder.write("rgb.txt", text.substr(0, cut + 1));
    folder.write("depth.txt", text.substr(cut + 3));
  }
  try {
    const hmcdyn::slam::FrameList list = hmcdyn::slam::readFrameList(folder.path());
    const std::vector<hmcdyn::slam::FrameEntry>& frames = list.frames;
    hmcdyn::fuzz::require(list.unit_seconds > 0.0, "a unit lasts");
    hmcdyn::fuzz::require(images && !frames.empty(), "a list has a frame");
    for (std::size_t i = 0; i < frames.size(); ++i) {
      hmcdyn::fuzz::require(frames[i].index == i, "frames are numbered");
      hmcdyn::fuzz::require(i == 0 || frames[i].timestamp > frames[i - 1].timestamp,
                            "frames are in the order of their time stamps");
    }
  } catch (const std::runtime_error&) {  // as documented
  }
  return 0;
}
