#include "core/transport/column_run.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/base/check.h"

namespace rimlight {
namespace {

constexpr std::size_t kWordBytes = sizeof(std::uint64_t);

std::size_t width_of(std::size_t section) { return section / kPlanes; }

struct Sizes {
  std::size_t blocks = 0;
  std::size_t value_bytes = 0;

  explicit Sizes(const std::uint16_t* counts) {
    for (std::size_t s = 0; s < ColumnRun::kSections; ++s) {
      blocks += counts[s];
      value_bytes += counts[s] * kBlockBytes[width_of(s)];
    }
  }
  std::size_t words() const {
    const std::size_t bytes = value_bytes + blocks * sizeof(std::uint16_t);
    return ColumnRun::kHeaderWords + (bytes + kWordBytes - 1) / kWordBytes;
  }
};

template <typename T>
void append(std::vector<std::uint8_t>& bytes, const T& value) {
  const auto* const from = reinterpret_cast<const std::uint8_t*>(&value);
  bytes.insert(bytes.end(), from, from + sizeof value);
}

template <typename T>
void append_rounded(std::vector<std::uint8_t>& bytes,
                    const std::array<float, kBlockReceivers>& value) {
  std::array<T, kBlockReceivers> stored;
  std::transform(value.begin(), value.end(), stored.begin(),
                 [](float v) { return static_cast<T>(v); });
  append(bytes, stored);
}

void append_values(ValueWidth width, const std::array<float, kBlockReceivers>& value,
                   std::vector<std::uint8_t>& bytes) {
  if (width == ValueWidth::full) return append_rounded<float>(bytes, value);
  if (width == ValueWidth::word) return append_rounded<std::int16_t>(bytes, value);
  if (width == ValueWidth::byte) return append_rounded<std::int8_t>(bytes, value);
  std::uint32_t nibbles = 0;
  for (std::size_t i = 0; i < kBlockReceivers; ++i) {
    nibbles |= (static_cast<std::uint32_t>(static_cast<int>(value[i])) & 15u) << (4 * i);
  }
  append(bytes, nibbles);
}

template <typename T>
void read_values(const std::uint8_t* from, std::array<float, kBlockReceivers>& value) {
  std::array<T, kBlockReceivers> stored;
  std::memcpy(stored.data(), from, sizeof stored);
  std::transform(stored.begin(), stored.end(), value.begin(),
                 [](T v) { return static_cast<float>(v); });
}

float largest_magnitude(const std::array<float, kBlockReceivers>& value) {
  float largest = 0;
  for (const float v : value) {
    RIMLIGHT_CHECK(std::isfinite(v));
    largest = std::max(largest, std::abs(v));
  }
  return largest;
}

/// Of numbers that are rounded, half up to odd: 7.5 would be 8.
ValueWidth narrowest(float largest) {
  for (std::size_t width = kWidths - 1; width > 0; --width) {
    if (largest < static_cast<float>(kLargestValue[width]) + 0.5f) {
      return static_cast<ValueWidth>(width);
    }
  }
  return ValueWidth::full;
}

bool has_ascending_indices(const std::uint16_t* index, std::size_t count) {
  int previous = -1;
  bool good = true;
  for (std::size_t i = 0; i < count; ++i) {
    good = good && index[i] > previous && index[i] < kTileBlocks;
    previous = index[i];
  }
  return good;
}

}  // namespace

std::size_t ColumnRun::block_count() const { return empty() ? 0 : Sizes(counts()).blocks; }

const std::uint16_t* ColumnRun::indices() const {
  return reinterpret_cast<const std::uint16_t*>(values() + Sizes(counts()).value_bytes);
}

const char* find_run_fault(std::span<const std::uint64_t> words) {
  if (words.empty()) return nullptr;
  if (words.size() < ColumnRun::kHeaderWords) return "a run without counts";
  const ColumnRun run(words);
  const Sizes sizes(run.counts());
  if (sizes.words() != words.size()) return "counts of another length";
  const std::uint16_t* index = run.indices();
  for (std::size_t s = 0; s < ColumnRun::kSections; ++s) {
    if (!has_ascending_indices(index, run.counts()[s])) return "block indices out of order";
    index += run.counts()[s];
  }
  std::size_t full = 0;
  for (std::size_t plane = 0; plane < kPlanes; ++plane) {
    full += run.section_count(ValueWidth::full, plane);
  }
  for (std::size_t i = 0; i < full * kBlockReceivers; ++i) {
    float value = 0;
    std::memcpy(&value, run.values() + i * sizeof value, sizeof value);
    if (!std::isfinite(value)) return "an infinity or NaN";
  }
  return nullptr;
}

RunCursor::RunCursor(const ColumnRun& run) {
  if (run.empty()) {
    section_ = ColumnRun::kSections;
    return;
  }
  counts_ = run.counts();
  values_ = run.values();
  index_ = run.indices();
  skip_empty_sections();
}

void RunCursor::skip_empty_sections() {
  while (!at_end() && in_section_ == counts_[section_]) {
    ++section_;
    in_section_ = 0;
  }
}

void RunCursor::next() {
  values_ += kBlockBytes[width_of(section_)];
  ++index_;
  ++in_section_;
  skip_empty_sections();
}

RunBlock RunCursor::block() const {
  RunBlock block{section_ % kPlanes, *index_, {}};
  if (width() == ValueWidth::full) read_values<float>(values_, block.value);
  if (width() == ValueWidth::word) read_values<std::int16_t>(values_, block.value);
  if (width() == ValueWidth::byte) read_values<std::int8_t>(values_, block.value);
  if (width() == ValueWidth::nibble) {
    std::uint32_t nibbles = 0;
    std::memcpy(&nibbles, values_, sizeof nibbles);
    for (std::size_t i = 0; i < kBlockReceivers; ++i) {
      const int low = static_cast<int>(nibbles >> (4 * i) & 15u);
      block.value[i] = static_cast<float>(low < 8 ? low : low - 16);
    }
  }
  return block;
}

void RunBuilder::add(const RunBlock& block) {
  RIMLIGHT_CHECK(block.plane < kPlanes && block.index < kTileBlocks);
  std::array<float, kBlockReceivers> value = block.value;
  const ValueWidth width = narrowest(largest_magnitude(value));
  for (float& v : value) v = std::abs(v) < 0x1p22f ? round_to_whole(v) : v;
  float energy = 0;
  for (const float v : value) energy += v * v;
  if (energy == 0 || energy < least_energy_) return;
  Section& section = sections_[static_cast<std::size_t>(width) * kPlanes + block.plane];
  RIMLIGHT_CHECK(section.index.empty() || section.index.back() < block.index);
  section.index.push_back(block.index);
  append_values(width, value, section.values);
}

void RunBuilder::finish(std::vector<std::uint64_t>& words) {
  std::array<std::uint16_t, ColumnRun::kSections> counts;
  for (std::size_t s = 0; s < counts.size(); ++s) {
    counts[s] = static_cast<std::uint16_t>(sections_[s].index.size());
  }
  const Sizes sizes(counts.data());
  if (sizes.blocks == 0) return;
  const std::size_t first = words.size();
  words.resize(first + sizes.words());
  auto* to = reinterpret_cast<std::uint8_t*>(words.data() + first);
  const auto put = [&to](const auto& values) {
    const std::size_t bytes = values.size() * sizeof(values[0]);
    if (bytes > 0) std::memcpy(to, values.data(), bytes);
    to += bytes;
  };
  put(counts);
  for (const Section& section : sections_) put(section.values);
  for (const Section& section : sections_) put(section.index);
  for (Section& section : sections_) {
    section.index.clear();
    section.values.clear();
  }
}

}  // namespace rimlight
