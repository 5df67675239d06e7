// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/place_index.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>

#include "slam/features/hamming_distance.hpp"

namespace hmcdyn::slam {
namespace {

constexpr int kDescriptorBits = 8 * kDescriptorBytes;

void checkRange(const char* argument, int value, int least, int most) {
  if (value < least || value > most) {
    throw std::invalid_argument(std::string(argument) + " is " + std::to_string(value) +
                                ", expected " + std::to_string(least) + ".." +
                                std::to_string(most));
  }
}

void checkDescriptors(const cv::Mat& descriptors) {
  if (!descriptors.empty() &&
      (descriptors.type() != CV_8UC1 || descriptors.cols != kDescriptorBytes)) {
    throw std::invalid_argument("descriptors has type " + std::to_string(descriptors.type()) +
                                " and " + std::to_string(descriptors.cols) +
                                " columns, expected CV_8U (0) and 32");
  }
}

/// For each table `bits` different bits, in ascending order.
std::vector<int> chooseBits(const PlaceIndexOptions& options) {
  std::mt19937 random(options.seed);
  std::vector<int> chosen;
  for (int table = 0; table < options.tables; ++table) {
    std::vector<int> all(kDescriptorBits);
    std::iota(all.begin(), all.end(), 0);
    for (int k = 0; k < options.bits; ++k) {  // the first steps of Fisher and Yates' shuffle
      const auto left = static_cast<std::uint32_t>(kDescriptorBits - k);
      std::swap(all[static_cast<std::size_t>(k)],
                all[static_cast<std::size_t>(k) + random() % left]);
    }
    std::sort(all.begin(), all.begin() + options.bits);
    chosen.insert(chosen.end(), all.begin(), all.begin() + options.bits);
  }
  return chosen;
}

}  // namespace

PlaceIndex::PlaceIndex(const PlaceIndexOptions& options) : options_(options) {
  checkRange("options.tables", options.tables, 1, 32);
  checkRange("options.bits", options.bits, 4, 20);
  checkRange("options.max_descriptors", options.max_descriptors, 1, 1 << 20);
  bits_ = chooseBits(options);
  postings_.resize(static_cast<std::size_t>(options.tables) << static_cast<unsigned>(options.bits));
}

std::vector<PlaceIndex::WordCount> PlaceIndex::wordsOf(const cv::Mat& descriptors) const {
  checkDescriptors(descriptors);
  const int rows = descriptors.rows;
  const int kept = std::min(rows, options_.max_descriptors);
  std::vector<std::uint32_t> words;
  words.reserve(static_cast<std::size_t>(kept) * static_cast<std::size_t>(options_.tables));
  for (int k = 0; k < kept; ++k) {
    const auto row = static_cast<int>(static_cast<std::int64_t>(k) * rows / kept);
    const auto* bytes = descriptors.ptr<std::uint8_t>(row);
    auto bit = bits_.begin();
    for (std::uint32_t table = 0; table < static_cast<std::uint32_t>(options_.tables); ++table) {
      std::uint32_t word = table;
      for (int i = 0; i < options_.bits; ++i, ++bit) {
        const auto at = static_cast<unsigned>(*bit);
        word = (word << 1U) | ((static_cast<unsigned>(bytes[at / 8U]) >> (at % 8U)) & 1U);
      }
      words.push_back(word);
    }
  }
  std::sort(words.begin(), words.end());
  std::vector<WordCount> counts;
  const float one = words.empty() ? 0.0f : 1.0f / static_cast<float>(words.size());
  for (auto word = words.begin(); word != words.end();) {
    const auto next = std::upper_bound(word, words.end(), *word);
    counts.push_back({*word, one * static_cast<float>(next - word)});
    word = next;
  }
  return counts;
}

double PlaceIndex::rarity(std::size_t postings) const {
  const auto holders = static_cast<double>(std::max<std::size_t>(postings, 1));
  return std::log1p(static_cast<double>(size()) / holders);
}

void PlaceIndex::add(std::size_t id, const cv::Mat& descriptors) {
  if (slot_of_.count(id) != 0) {
    throw std::invalid_argument("id is " + std::to_string(id) +
                                ", expected one that is not in the index");
  }
  const std::vector<WordCount> words = wordsOf(descriptors);
  if (free_slots_.empty()) {
    free_slots_.push_back(static_cast<std::uint32_t>(slots_.size()));
    slots_.emplace_back();
  }
  const std::uint32_t number = free_slots_.back();
  free_slots_.pop_back();
  slot_of_[id] = number;
  Slot& slot = slots_[number];
  slot.id = id;
  slot.words.reserve(words.size());
  for (const WordCount& word : words) {
    slot.words.push_back(word.word);
    postings_[word.word].push_back({number, word.share});
  }
}

bool PlaceIndex::remove(std::size_t id) {
  const auto found = slot_of_.find(id);
  if (found == slot_of_.end()) {
    return false;
  }
  const std::uint32_t number = found->second;
  for (const std::uint32_t word : slots_[number].words) {
    std::vector<Posting>& postings = postings_[word];
    const auto own = std::find_if(postings.begin(), postings.end(),
                                  [number](const Posting& entry) { return entry.slot == number; });
    *own = postings.back();  // their order does not matter
    postings.pop_back();
  }
  slots_[number] = Slot();
  free_slots_.push_back(number);
  slot_of_.erase(found);
  return true;
}

std::vector<PlaceCandidate> PlaceIndex::query(const cv::Mat& descriptors, std::size_t max_results,
                                              const std::vector<std::size_t>& exclude) const {
  // Words ascend, so that a key frame's score is summed in one order wherever its postings stand.
  std::vector<double> shared(slots_.size(), 0.0);
  double own = 0.0;
  for (const WordCount& word : wordsOf(descriptors)) {
    const std::vector<Posting>& postings = postings_[word.word];
    const double weight = rarity(postings.size());
    own += weight * static_cast<double>(word.share);
    for (const Posting& posting : postings) {
      shared[posting.slot] += weight * static_cast<double>(std::min(word.share, posting.share));
    }
  }
  std::vector<PlaceCandidate> candidates;
  for (const auto& [id, slot] : slot_of_) {
    if (shared[slot] > 0.0 && std::find(exclude.begin(), exclude.end(), id) == exclude.end()) {
      candidates.push_back({id, shared[slot] / own});
    }
  }
  const auto better = [](const PlaceCandidate& a, const PlaceCandidate& b) {
    return a.score > b.score || (a.score == b.score && a.id < b.id);
  };
  const std::size_t wanted = std::min(max_results, candidates.size());
  std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(wanted),
                    candidates.end(), better);
  candidates.resize(wanted);
  return candidates;
}

}  // namespace hmcdyn::slam
