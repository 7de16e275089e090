#include "core/transport/transport.h"

#include <algorithm>
#include <array>
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

/// The sizes of all arrays follow from the two counts and the number of words.
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
  auto fault = compare("column_step", arrays.column_step.size(), arrays.column_count);
  if (!fault) {
    fault = compare("tile_first_word", arrays.tile_first_word.size(),
                    checked_sum(arrays.tile_count, 1));
  }
  if (!fault) {
    fault = compare("run_offset", arrays.run_offset.size(),
                    checked_product(arrays.tile_count, arrays.column_count + 1));
  }
  return fault;
}

std::optional<Fault> step_fault(const Arrays& arrays) {
  const auto bad = std::ranges::find_if_not(arrays.column_step, [](float step) {
    return step >= 0 && step <= std::numeric_limits<float>::max();
  });
  if (bad == arrays.column_step.end()) return std::nullopt;
  return Fault{"column_step[" + std::to_string(bad - arrays.column_step.begin()) + "]",
               std::to_string(*bad), "a finite number, 0 or more"};
}

std::optional<Fault> first_word_fault(const Arrays& arrays) {
  const auto& first = arrays.tile_first_word;
  if (first.front() != 0 || first.back() != arrays.runs.size()) {
    return Fault{"tile_first_word",
                 std::to_string(first.front()) + " to " + std::to_string(first.back()),
                 "0 to " + std::to_string(arrays.runs.size())};
  }
  const auto drop = std::adjacent_find(first.begin(), first.end(), std::greater<>());
  if (drop == first.end()) return std::nullopt;
  return Fault{"tile_first_word[" + std::to_string(drop - first.begin() + 1) + "]",
               std::to_string(*(drop + 1)), "at least " + std::to_string(*drop)};
}

/// Everything inside one tile; its first and last word have been checked.
std::optional<Fault> tile_fault(const TransportView& view, std::size_t tile) {
  const Arrays& arrays = view.arrays();
  const auto offset =
      arrays.run_offset.subspan(tile * (arrays.column_count + 1), arrays.column_count + 1);
  const std::size_t words = arrays.tile_first_word[tile + 1] - arrays.tile_first_word[tile];
  if (offset.front() != 0 || offset.back() != words) {
    return Fault{place("run_offset", tile, 0),
                 std::to_string(offset.front()) + " to " + std::to_string(offset.back()),
                 "0 to " + std::to_string(words)};
  }
  const auto drop = std::adjacent_find(offset.begin(), offset.end(), std::greater<>());
  if (drop != offset.end()) {
    return Fault{place("run_offset", tile, static_cast<std::size_t>(drop - offset.begin()) + 1),
                 std::to_string(*(drop + 1)), "at least " + std::to_string(*drop)};
  }
  for (std::size_t column = 0; column < arrays.column_count; ++column) {
    if (const char* const found = find_run_fault(view.run(tile, column).words())) {
      return Fault{place("runs", tile, column), found, "a run of blocks"};
    }
  }
  return std::nullopt;
}

[[noreturn]] void fail(const std::string& source, const Fault& fault) {
  throw Error(source + ": " + fault.array, fault.found, fault.expected);
}

std::uint32_t add_clamped(std::uint32_t sum, std::uint64_t more) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  return static_cast<std::uint32_t>(std::min(kMost, sum + more));
}

}  // namespace

TransportView::TransportView(const Arrays& arrays, const std::string& source) : arrays_(arrays) {
  // Owners align their arrays: not a matter of what a file says.
  RIMLIGHT_CHECK_EQ(reinterpret_cast<std::uintptr_t>(arrays.runs.data()) % 8, 0u);
  if (const auto fault = size_fault(arrays)) fail(source, *fault);
  if (const auto fault = step_fault(arrays)) fail(source, *fault);
  if (const auto fault = first_word_fault(arrays)) fail(source, *fault);
  // The first fault in tile order is told, whichever thread found it.
  std::vector<std::optional<Fault>> faults(arrays.tile_count);
  parallel_for(arrays.tile_count,
               [&](std::size_t tile) { faults[tile] = tile_fault(*this, tile); });
  for (const auto& fault : faults) {
    if (fault) fail(source, *fault);
  }
}

std::vector<std::uint32_t> count_column_bytes(const TransportView& transport) {
  std::vector<std::uint32_t> bytes(transport.column_count());
  parallel_for(bytes.size(), [&](std::size_t column) {
    for (std::size_t tile = 0; tile < transport.tile_count(); ++tile) {
      bytes[column] = add_clamped(bytes[column], transport.run(tile, column).words().size_bytes());
    }
  });
  return bytes;
}

std::vector<PartSize> measure_parts(const TransportView& transport) {
  constexpr std::size_t kCountBytes = ColumnRun::kHeaderWords * sizeof(std::uint64_t);
  std::vector<PartSize> sizes(transport.column_count() * kLayers);
  parallel_for(transport.column_count(), [&](std::size_t column) {
    for (std::size_t tile = 0; tile < transport.tile_count(); ++tile) {
      const ColumnRun run = transport.run(tile, column);
      if (run.empty()) continue;
      std::array<std::size_t, kLayers> bytes{}, blocks{};
      for (std::size_t width = 0; width < kWidths; ++width) {
        const std::size_t layer = layer_of(static_cast<ValueWidth>(width));
        for (std::size_t plane = 0; plane < kPlanes; ++plane) {
          const std::size_t count = run.section_count(static_cast<ValueWidth>(width), plane);
          blocks[layer] += count;
          bytes[layer] += count * (kBlockBytes[width] + sizeof(std::uint16_t));
        }
      }
      for (std::size_t layer = 0; layer < kLayers; ++layer) {
        if (blocks[layer] == 0) continue;
        PartSize& size = sizes[part_of(column, layer)];
        size.bytes = add_clamped(size.bytes, (bytes[layer] + kCountBytes + 7) / 8 * 8);
        size.blocks = add_clamped(size.blocks, blocks[layer]);
        size.runs = add_clamped(size.runs, 1);
      }
    }
  });
  return sizes;
}

}  // namespace rimlight
