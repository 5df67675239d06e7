// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <unistd.h>

#include "synthesize/sequence.hpp"

namespace hmcdyn::test {

/// A rendered sequence, 640 x 480: in `own`, or, where the environment variable
/// HMCDYN_RENDERED_SEQUENCES names a folder, in that one, for the next build's tests to read (the
/// files do not depend on the build, and with sanitizers rendering takes minutes). The tests of the
/// renderer itself render in every build.
/// @return its folder, which is not to be changed.
inline std::filesystem::path renderedSequence(const std::filesystem::path& own,
                                              const std::string& scene, int frames,
                                              synthesize::NoiseModel noise) {
  const std::string name = scene + "_" + std::to_string(frames) +
                           (noise == synthesize::NoiseModel::kNone ? "_exact" : "_noise");
  const char* shared = std::getenv("HMCDYN_RENDERED_SEQUENCES");
  const bool is_shared = shared != nullptr && *shared != '\0';
  const std::filesystem::path folder = (is_shared ? std::filesystem::path(shared) : own) / name;
  if (std::filesystem::exists(folder)) {
    return folder;
  }
  synthesize::SequenceOptions options;
  options.scene = scene;
  options.frames = frames;
  options.noise = noise;
  // Nobody finds a half of it.
  options.output = folder.string() + "." + std::to_string(getpid());
  synthesize::writeSequence(options, {});
  std::filesystem::rename(options.output, folder);
  return folder;
}

}  // namespace hmcdyn::test
