// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

namespace hmcdyn::slam {

struct PlaceIndexOptions {
  int tables = 4;          ///< Independent choices of bits, 1..32.
  int bits = 16;           ///< Bits of a descriptor that make a word, 4..20.
  std::uint32_t seed = 1;  ///< Of the choice of bits.
  /// Descriptors of a key frame that are kept, >= 1; of more, as many are taken at even distances.
  /// A key frame costs at most 12 bytes a kept descriptor and table.
  int max_descriptors = 2000;
};

/// A key frame that looks alike.
struct PlaceCandidate {
  std::size_t id = 0;
  double score = 0.0;  ///< 0..1; 1 = the same words in the same shares.
};

/// Which key frames look like a frame, by its binary descriptors and without a vocabulary.
///
/// A few bits of a descriptor, chosen at random once, make its word; several choices make several
/// words a descriptor, of which an equal point seen again keeps some. An inverted index leads from
/// a word to the key frames that hold it. The idea is that of the hashed bag of words in basalt
/// (Usenko et al., Visual-Inertial Mapping with Non-Linear Factor Recovery, 2019); the score is the
/// intersection of the two histograms of words, each summing to 1, in which a word counts by its
/// rarity log(1 + N / n) among the N key frames (as in Sivic and Zisserman, 2003), divided by the
/// frame's intersection with itself.
///
/// The answer depends on the set of key frames alone, not on the order in which they came or on
/// what was removed since. Not synchronised: one thread, or copies.
class PlaceIndex {
 public:
  /// @throws std::invalid_argument on options out of their range.
  explicit PlaceIndex(const PlaceIndexOptions& options = {});

  /// @param descriptors N x 32, CV_8U; empty = a key frame that nothing looks like.
  /// @throws std::invalid_argument on another type or width, or an id that is in the index.
  void add(std::size_t id, const cv::Mat& descriptors);

  /// False where the id is not in the index.
  bool remove(std::size_t id);

  /// Key frames that share a word with the frame, best first, at equal scores by id.
  /// @param exclude ids that are not wanted, in any order.
  /// @throws std::invalid_argument on descriptors of another type or width.
  std::vector<PlaceCandidate> query(const cv::Mat& descriptors, std::size_t max_results,
                                    const std::vector<std::size_t>& exclude = {}) const;

  std::size_t size() const noexcept { return slot_of_.size(); }

 private:
  struct WordCount {
    std::uint32_t word = 0;  // of all tables, numbered through
    float share = 0.0f;      // of the key frame's words
  };
  struct Posting {
    std::uint32_t slot = 0;
    float share = 0.0f;
  };
  struct Slot {
    std::size_t id = 0;
    std::vector<std::uint32_t> words;  // ascending, each once
  };

  std::vector<WordCount> wordsOf(const cv::Mat& descriptors) const;
  double rarity(std::size_t postings) const;

  PlaceIndexOptions options_;
  std::vector<int> bits_;                       // tables * bits of the descriptor
  std::vector<std::vector<Posting>> postings_;  // per word
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> free_slots_;
  std::map<std::size_t, std::uint32_t> slot_of_;
};

}  // namespace hmcdyn::slam
