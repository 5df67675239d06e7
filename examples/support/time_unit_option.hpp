// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "support/time_stamps.hpp"

namespace hmcdyn::support {

/// Adds --time-unit, whose default auto leaves `unit` empty. @param what whose unit it is.
/// @return the option. @param frames whether frame numbers are one, for programs that know a frame
/// rate.
inline CLI::Option* addTimeUnit(CLI::App& app, std::optional<TimeUnit>& unit,
                                const std::string& what, bool frames = false) {
  std::map<std::string, TimeUnit> names{{"s", TimeUnit::kSeconds},
                                        {"ms", TimeUnit::kMilliseconds},
                                        {"us", TimeUnit::kMicroseconds},
                                        {"ns", TimeUnit::kNanoseconds}};
  if (frames) {
    names.emplace("frame", TimeUnit::kFrames);
  }
  const std::string list = frames ? "{auto,s,ms,us,ns,frame}" : "{auto,s,ms,us,ns}";
  return app
      .add_option_function<std::string>(
          "--time-unit",
          [&unit, names](const std::string& name) {
            unit = name == "auto" ? std::nullopt : std::optional<TimeUnit>(names.at(name));
          },
          what + (frames ? "; frame: they are frame numbers, at the camera's frame rate" : "") +
              "; auto: what is plausible, which is said")
      ->check(CLI::Validator(
          [names](const std::string& name) {
            return name == "auto" || names.count(name) > 0 ? std::string()
                                                           : "'" + name + "' is no unit of time";
          },
          list))
      ->default_str("auto");
}

}  // namespace hmcdyn::support
