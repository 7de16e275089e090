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
constexpr std::size_t kGroupsAtOnce = 8;  // each up to 19 MB at N = 64

}  // namespace

void write_reference(BakeWriter& writer, const GroupSource& source, std::size_t receivers) {
  auto sample = sample_groups(source, (receivers + kGroupLanes - 1) / kGroupLanes, kSampleSeed);
  std::sort(sample.begin(), sample.end());
  const std::vector<std::uint64_t> firsts(sample.begin(), sample.end());
  const auto file = writer.create(
      kReferenceFile, reference_tensors(firsts.size(), cube::texel_count(source.cube_size())));
  file->append(std::span<const std::uint64_t>(firsts));
  std::vector<BakedGroup> groups(std::min(kGroupsAtOnce, sample.size()),
                                 BakedGroup(source.cube_size()));
  for (std::size_t begin = 0; begin < sample.size(); begin += groups.size()) {
    const std::size_t count = std::min(groups.size(), sample.size() - begin);
    parallel_for(count, [&](std::size_t i) { source.find_rows(sample[begin + i], groups[i]); });
    for (std::size_t i = 0; i < count; ++i) {
      file->append(std::span<const float>(groups[i].coefficients.values));
    }
  }
  writer.add_file(kReferenceFile, file->finish());
}

}  // namespace rimlight
