#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/transport/receiver_planes.h"
#include "core/transport/receivers.h"

namespace rimlight {

/// How wide a block's eight numbers are stored: as narrow as holds them. They are whole multiples
/// of the column's step (in `full`, from 2²² on, what a float holds).
enum class ValueWidth : std::uint8_t { full, word, byte, nibble };  // float, i16, i8, i4
inline constexpr std::size_t kWidths = 4;
inline constexpr std::array<std::size_t, kWidths> kBlockBytes = {32, 16, 8, 4};
/// The largest magnitude that a whole number of each width but `full` takes.
inline constexpr std::array<int, kWidths> kLargestValue = {0, 32767, 127, 7};

/// A column is added whole or in layers, by how wide its blocks are: the few wide ones hold nearly
/// all of a column's energy (of the default scene 70 to 99 %, in 4 to 12 % of the blocks), and the
/// many narrow ones fill in the rest. Layers:  0 full and word, 1 byte, 2 nibble.
inline constexpr std::size_t kLayers = 3;
constexpr std::size_t layer_of(ValueWidth width) {
  return width == ValueWidth::nibble ? 2 : width == ValueWidth::byte ? 1 : 0;
}
/// A set of layers: bit `layer`.
using LayerSet = std::uint8_t;
inline constexpr LayerSet kAllLayers = (1 << kLayers) - 1;

/// A layer of a column; parts are in order of columns.
constexpr std::size_t part_of(std::size_t column, std::size_t layer) {
  return column * kLayers + layer;
}

/// One column's run in one tile, as it lies in memory and in the file; little-endian:
///
///     u16 count[width][plane]            blocks of each section, 24 bytes
///     values of full, word, byte, nibble sections, planes in order: [block][8]; the eight of a
///                                        nibble block from the lowest bits up, two's complement
///     u16 index of each block            in the same order; < 512, ascending in each section
///     zeros to a multiple of 8 bytes
///
/// A column without blocks in the tile has an empty run, without counts. Immutable view.
class ColumnRun {
 public:
  static constexpr std::size_t kSections = kWidths * kPlanes;
  static constexpr std::size_t kHeaderWords = kSections * sizeof(std::uint16_t) / 8;

  ColumnRun() = default;
  /// Words that is_valid_run() has found right.
  explicit ColumnRun(std::span<const std::uint64_t> words) : words_(words) {}

  std::span<const std::uint64_t> words() const { return words_; }
  bool empty() const { return words_.empty(); }
  std::size_t section_count(ValueWidth width, std::size_t plane) const {
    return counts()[static_cast<std::size_t>(width) * kPlanes + plane];
  }
  /// Number of blocks of all sections.
  std::size_t block_count() const;

  const std::uint16_t* counts() const {
    return reinterpret_cast<const std::uint16_t*>(words_.data());
  }
  const std::uint8_t* values() const {
    return reinterpret_cast<const std::uint8_t*>(words_.data() + kHeaderWords);
  }
  /// The indices follow the values: 8-byte-aligned widths first, so that all are aligned.
  const std::uint16_t* indices() const;

 private:
  std::span<const std::uint64_t> words_;
};

/// What is wrong with words that should be a run, or nullptr: counts, length, indices, values that
/// are not finite. Any words may be given.
const char* find_run_fault(std::span<const std::uint64_t> words);

/// One block in the clear: eight multiples of the column's step.
struct RunBlock {
  std::size_t plane = 0;
  std::uint16_t index = 0;
  std::array<float, kBlockReceivers> value{};
};

/// Walks over a run's blocks in the order in which they are stored:
///     for (RunCursor at(run); !at.at_end(); at.next()) use(at.block());
class RunCursor {
 public:
  explicit RunCursor(const ColumnRun& run);
  bool at_end() const { return section_ == ColumnRun::kSections; }
  void next();
  RunBlock block() const;
  ValueWidth width() const { return static_cast<ValueWidth>(section_ / kPlanes); }

 private:
  void skip_empty_sections();

  const std::uint16_t* counts_ = nullptr;
  const std::uint8_t* values_ = nullptr;
  const std::uint16_t* index_ = nullptr;
  std::size_t section_ = 0;
  std::size_t in_section_ = 0;
};

/// To the nearest whole number, ties to even; |value| < 2²². (nearbyint is a call without SSE 4.1;
/// this vectorises.)
inline float round_to_whole(float value) {
  constexpr float kUnitsOnly = 0x1.8p23f;  // between 2²³ and 2²⁴ floats are whole
  return (value + kUnitsOnly) - kUnitsOnly;
}

/// Puts a run together, block by block.
class RunBuilder {
 public:
  /// Leaves out blocks whose Σ value² (of the rounded values, in steps²) is below `least_energy`.
  explicit RunBuilder(float least_energy) : least_energy_(least_energy) {}

  /// Rounds to whole steps, ties to even; takes the narrowest width that holds them. Indices ascend
  /// within a plane. Finite, else CheckFailure.
  void add(const RunBlock& block);

  /// Appends the run's words, and starts the next.
  void finish(std::vector<std::uint64_t>& words);

 private:
  struct Section {
    std::vector<std::uint16_t> index;
    std::vector<std::uint8_t> values;
  };

  float least_energy_;
  std::array<Section, ColumnRun::kSections> sections_;
};

}  // namespace rimlight
