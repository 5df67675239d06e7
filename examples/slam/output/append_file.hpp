// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace hmcdyn::slam {

/// A text file that only grows. What was appended is with the operating system at once, so it stays
/// when the program is killed.
class AppendFile {
 public:
  /// Creates the file, or empties the one that is there.
  /// @throws std::runtime_error naming the file and the reason where that fails.
  explicit AppendFile(std::filesystem::path path);
  ~AppendFile();
  AppendFile(AppendFile&& other) noexcept;
  AppendFile& operator=(AppendFile&& other) noexcept;
  AppendFile(const AppendFile&) = delete;
  AppendFile& operator=(const AppendFile&) = delete;

  /// Appends all of the text or none of it.
  /// @throws std::runtime_error naming the file and the reason, such as a full disk; what was
  /// appended before stays.
  void append(std::string_view text);

  /// Renames the file, in one step and over one that is there; later appends go on in it.
  /// @throws std::runtime_error naming both files and the reason; the file keeps its name.
  void moveTo(const std::filesystem::path& path);

  const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::int64_t size_ = 0;  // bytes of the complete appends
};

/// Replaces a file in one step: a reader finds the old content or the new, never a part. The text
/// goes to `path` with ".tmp" behind it first.
/// @throws std::runtime_error naming the file and the reason; the old content stays.
void replaceFile(const std::filesystem::path& path, std::string_view text);

}  // namespace hmcdyn::slam
