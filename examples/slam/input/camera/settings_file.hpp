// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace hmcdyn::slam {

/// A value of a settings file.
struct Setting {
  std::string key;                   ///< "Camera.fx", whether it is written so or nested.
  std::size_t line = 0;              ///< In the file, from 1.
  bool is_list = false;              ///< Of scalars, perhaps in lists themselves.
  std::vector<std::string> scalars;  ///< The value; one where it is no list, none where it is null.
  std::string text;                  ///< As it is written, to be quoted.
  std::string error;                 ///< Why it cannot be read; empty = it can.
};

/// The keys of a settings file, in the YAML that OpenCV's cv::FileStorage reads and writes, or any
/// other. Each of the outermost keys is read on its own, so that one which is no YAML does not
/// matter unless it is asked for. A value may follow its colon without a blank, "%YAML" lines and
/// marks of documents are skipped, tabs are blanks, the text may be in UTF-16 (toText()).
class SettingsFile {
 public:
  /// @throws std::runtime_error that names the file where it cannot be read, or has no key at all.
  explicit SettingsFile(std::filesystem::path file);

  const std::vector<Setting>& settings() const noexcept { return settings_; }

  /// The value of a key, nothing where there is none.
  /// @throws std::runtime_error where the key has two different values.
  const Setting* find(const std::string& key) const;
  bool has(const std::string& key) const { return find(key) != nullptr; }

  /// The first of several keys that is there; empty where none is.
  std::string firstOf(const std::vector<std::string>& keys) const;

  /// The value of a key as a finite number.
  /// @throws std::runtime_error that names file, line and key where it is missing or anything else.
  double number(const std::string& key) const;
  /// The same, above 0.
  double positive(const std::string& key) const;
  /// The same, a whole number above 0.
  int positiveInteger(const std::string& key) const;
  std::string text(const std::string& key) const;
  /// A list of finite numbers.
  std::vector<double> numbers(const std::string& key) const;

  /// "FILE:LINE: key message", without the line where the key is missing.
  std::runtime_error failure(const std::string& key, const std::string& message) const;
  std::runtime_error failure(const std::string& message) const;

 private:
  const Setting& required(const std::string& key) const;
  double toNumber(const Setting& setting, const std::string& scalar) const;
  void readBlock(const std::vector<std::string>& lines, std::size_t first);

  std::filesystem::path file_;
  std::vector<std::string> lines_;  // of the file, for what is no setting and should be one
  std::vector<Setting> settings_;
};

}  // namespace hmcdyn::slam
