#include "core/bake/reference_output.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/bake/pilot.h"
#include "core/base/parallel.h"
#include "core/transport/reference_rows.h"

namespace rimlight {
namespace {

constexpr std::uint64_t kSampleSeed = 0x5ef;
constexpr std::size_t kGroupsAtOnce = 8;       // each up to 19 MB at N = 64
constexpr std::size_t kFinerGroupsAtOnce = 2;  // four times as large

using Groups = std::vector<std::uint64_t>;

/// Appends the first receivers, and what `part` takes of each group's rows, in their order.
template <typename Part>
void append_rows(TensorFileWriter& file, const GroupSource& source, const Groups& groups,
                 std::size_t at_once, const Part& part) {
  file.append(std::span<const std::uint64_t>(groups));
  std::vector<BakedGroup> baked(std::min(at_once, groups.size()), BakedGroup(source.cube_size()));
  for (std::size_t begin = 0; begin < groups.size(); begin += baked.size()) {
    const std::size_t count = std::min(baked.size(), groups.size() - begin);
    parallel_for(count, [&](std::size_t i) {
      source.find_rows(groups[begin + i], baked[i]);
      if (baked[i].empty) std::ranges::fill(baked[i].coefficients.values, 0.0f);
    });
    for (std::size_t i = 0; i < count; ++i) {
      file.append(part(std::span<const float>(baked[i].coefficients.values)));
    }
  }
}

/// Every kGroupsPerCheck-th, the first included.
Groups thin_out(const Groups& groups) {
  Groups result;
  for (std::size_t i = 0; i < groups.size(); i += kGroupsPerCheck) result.push_back(groups[i]);
  return result;
}

}  // namespace

void write_reference(BakeWriter& writer, const ReferenceSources& sources, std::size_t receivers) {
  const auto sample =
      sample_groups(sources.rows, (receivers + kGroupLanes - 1) / kGroupLanes, kSampleSeed);
  Groups groups(sample.begin(), sample.end());
  std::ranges::sort(groups);
  const Groups checked = thin_out(groups);
  const ReferenceCounts counts = {groups.size(), sources.retraced != nullptr ? checked.size() : 0,
                                  sources.finer != nullptr ? checked.size() : 0};
  const std::size_t columns = cube::texel_count(sources.rows.cube_size());
  const auto file = writer.create(kReferenceFile, reference_tensors(counts, columns));
  const auto whole = [](std::span<const float> rows) { return rows; };
  append_rows(*file, sources.rows, groups, kGroupsAtOnce, whole);
  if (counts.retraced > 0) append_rows(*file, *sources.retraced, checked, kGroupsAtOnce, whole);
  if (counts.finer > 0) {
    append_rows(*file, *sources.finer, checked, kFinerGroupsAtOnce,
                [columns](auto rows) { return rows.subspan(columns * kRowLanes); });
  }
  writer.add_file(kReferenceFile, file->finish());
}

}  // namespace rimlight
