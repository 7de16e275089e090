#include "core/transport/transport.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "core/base/check.h"
#include "core/base/checked.h"
#include "core/base/error.h"
#include "core/base/parallel.h"

namespace rimlight {
namespace {

using Arrays = TransportView::Arrays;

struct Fault {
  std::string array, found, expected;
};

std::string place(const char* array, std::size_t tile, std::size_t column) {
  return std::string(array) + "[" + std::to_string(tile) + "][" + std::to_string(column) + "]";
}

/// The sizes of all arrays follow from the two counts and the number of blocks.
std::optional<Fault> size_fault(const Arrays& arrays) {
  const auto compare = [](const char* name, std::size_t found,
                          std::optional<std::size_t> expected) -> std::optional<Fault> {
    if (expected && found == *expected) return std::nullopt;
    return Fault{name, std::to_string(found) + " elements",
                 expected ? std::to_string(*expected) : "a size that fits in memory"};
  };
  if (arrays.column_count == 0 || arrays.column_count > TransportView::kMostColumns) {
    return Fault{"column_count", std::to_string(arrays.column_count),
                 "1 to " + std::to_string(TransportView::kMostColumns)};
  }
  const std::size_t blocks = arrays.block_index.size();
  auto fault = compare("tile_first_block", arrays.tile_first_block.size(),
                       checked_sum(arrays.tile_count, 1));
  if (!fault) {
    fault = compare("column_offset", arrays.column_offset.size(),
                    checked_product(arrays.tile_count, arrays.column_count + 1));
  }
  if (!fault) {
    fault = compare("column_scale", arrays.column_scale.size(),
                    checked_product(arrays.tile_count, arrays.column_count));
  }
  if (!fault) fault = compare("value", arrays.values.size(), checked_product(blocks, kBlockFloats));
  return fault;
}

std::optional<Fault> first_block_fault(const Arrays& arrays) {
  const auto& first = arrays.tile_first_block;
  if (first.front() != 0 || first.back() != arrays.block_index.size()) {
    return Fault{"tile_first_block",
                 std::to_string(first.front()) + " to " + std::to_string(first.back()),
                 "0 to " + std::to_string(arrays.block_index.size())};
  }
  const auto drop = std::adjacent_find(first.begin(), first.end(), std::greater<>());
  if (drop == first.end()) return std::nullopt;
  return Fault{"tile_first_block[" + std::to_string(drop - first.begin() + 1) + "]",
               std::to_string(*(drop + 1)), "at least " + std::to_string(*drop)};
}

bool has_exponent_31(std::span<const Half> values) {
  // No early exit: the loop vectorises, and good files are the rule.
  std::uint16_t found = 0;
  for (const Half value : values) found |= static_cast<std::uint16_t>((value & 0x7c00) == 0x7c00);
  return found != 0;
}

std::optional<Fault> run_fault(std::size_t tile, std::size_t column, const ColumnRun& run) {
  if (!(run.scale >= 0 && run.scale <= std::numeric_limits<float>::max())) {
    return Fault{place("column_scale", tile, column), std::to_string(run.scale),
                 "a finite number, 0 or more"};
  }
  int previous = -1;
  for (const std::uint16_t index : run.block_index) {
    if (index <= previous || index >= kTileBlocks) {
      return Fault{place("block_index of run ", tile, column), std::to_string(index),
                   "ascending from 0 to " + std::to_string(kTileBlocks - 1)};
    }
    previous = index;
  }
  return std::nullopt;
}

/// Everything inside one tile; its first and last block have been checked.
std::optional<Fault> tile_fault(const TransportView& view, std::size_t tile) {
  const Arrays& arrays = view.arrays();
  const auto offset =
      arrays.column_offset.subspan(tile * (arrays.column_count + 1), arrays.column_count + 1);
  const std::size_t blocks = view.tile_block_count(tile);
  if (offset.front() != 0 || offset.back() != blocks) {
    return Fault{place("column_offset", tile, 0),
                 std::to_string(offset.front()) + " to " + std::to_string(offset.back()),
                 "0 to " + std::to_string(blocks)};
  }
  const auto drop = std::adjacent_find(offset.begin(), offset.end(), std::greater<>());
  if (drop != offset.end()) {
    return Fault{place("column_offset", tile, static_cast<std::size_t>(drop - offset.begin()) + 1),
                 std::to_string(*(drop + 1)), "at least " + std::to_string(*drop)};
  }
  for (std::size_t column = 0; column < arrays.column_count; ++column) {
    if (auto fault = run_fault(tile, column, view.run(tile, column))) return fault;
  }
  const auto values =
      arrays.values.subspan(arrays.tile_first_block[tile] * kBlockFloats, blocks * kBlockFloats);
  if (has_exponent_31(values)) {
    return Fault{"value of tile " + std::to_string(tile), "an infinity or NaN", "finite halves"};
  }
  return std::nullopt;
}

[[noreturn]] void fail(const std::string& source, const Fault& fault) {
  throw Error(source + ": " + fault.array, fault.found, fault.expected);
}

}  // namespace

TransportView::TransportView(const Arrays& arrays, const std::string& source) : arrays_(arrays) {
  // Owners align their arrays: not a matter of what a file says.
  RIMLIGHT_CHECK_EQ(reinterpret_cast<std::uintptr_t>(arrays.values.data()) % 16, 0u);
  if (const auto fault = size_fault(arrays)) fail(source, *fault);
  if (const auto fault = first_block_fault(arrays)) fail(source, *fault);
  // The first fault in tile order is told, whichever thread found it.
  std::vector<std::optional<Fault>> faults(arrays.tile_count);
  parallel_for(arrays.tile_count,
               [&](std::size_t tile) { faults[tile] = tile_fault(*this, tile); });
  for (const auto& fault : faults) {
    if (fault) fail(source, *fault);
  }
}

}  // namespace rimlight
