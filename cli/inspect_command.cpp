#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/inspect_curves.h"
#include "cli/inspect_parts.h"
#include "cli/inspect_vertices.h"
#include "core/basis/cube_haar.h"
#include "core/transport/bake_folder.h"
#include "core/transport/column_kernel.h"
#include "core/transport/vertex_bake.h"

namespace rimlight {
namespace {

using nlohmann::json;

struct InspectOptions {
  std::string folder;
  bool verify = false;
  bool json = false;
};

constexpr std::array<const char*, kWidths> kWidthNames = {"float", "16-bit", "8-bit", "4-bit"};
constexpr std::array<const char*, kPlanes> kPlaneNames = {"luma", "chroma_red", "chroma_blue"};

/// Columns of a band of which nothing is stored in any tile.
std::size_t count_empty_columns(const Bake& bake, const CubeHaar& haar, int band) {
  const auto first =
      bake.column_bytes().begin() + static_cast<std::ptrdiff_t>(haar.band_begin(band));
  const auto last =
      bake.column_bytes().begin() + static_cast<std::ptrdiff_t>(haar.band_begin(band + 1));
  return static_cast<std::size_t>(std::count(first, last, 0u));
}

/// What a band of the bake holds.
json describe_band(const Bake& bake, const CubeHaar& haar, int band) {
  const TransportView& transport = bake.transport();
  std::array<std::size_t, kWidths> by_width{};
  std::array<std::size_t, kPlanes> by_plane{};
  std::size_t runs = 0, blocks = 0, bytes = 0;
  for (std::size_t tile = 0; tile < transport.tile_count(); ++tile) {
    for (std::size_t column = haar.band_begin(band); column < haar.band_begin(band + 1); ++column) {
      const ColumnRun run = transport.run(tile, column);
      if (run.empty()) continue;
      ++runs;
      bytes += run.words().size_bytes();
      for (std::size_t section = 0; section < ColumnRun::kSections; ++section) {
        const std::size_t count = run.counts()[section];
        by_width[section / kPlanes] += count;
        by_plane[section % kPlanes] += count;
        blocks += count;
      }
    }
  }
  const std::size_t columns = haar.band_begin(band + 1) - haar.band_begin(band);
  const double all = static_cast<double>(columns) * static_cast<double>(transport.tile_count()) *
                     static_cast<double>(kTileBlocks);
  json result = {{"band", band},
                 {"columns", columns},
                 {"columns_left_out", count_empty_columns(bake, haar, band)},
                 {"runs", runs},
                 {"blocks", blocks},
                 {"density", static_cast<double>(by_plane[0]) / all},
                 {"bytes", bytes}};
  for (std::size_t i = 0; i < kWidths; ++i) result["blocks_by_width"][kWidthNames[i]] = by_width[i];
  for (std::size_t i = 0; i < kPlanes; ++i) result["blocks_by_plane"][kPlaneNames[i]] = by_plane[i];
  return result;
}

json describe(const Bake& bake) {
  const BakeManifest& manifest = bake.manifest();
  const CubeHaar haar(manifest.cube_size);
  json result = {{"bake", bake.folder().string()},
                 {"kind", manifest.kind},
                 {"version", manifest.version},
                 {"scene", manifest.scene},
                 {"width", manifest.pixels.width},
                 {"height", manifest.pixels.height},
                 {"cube_size", manifest.cube_size},
                 {"columns", bake.transport().column_count()},
                 {"transport_bytes", bake.transport().byte_count()},
                 {"settings", manifest.settings},
                 {"measured", manifest.measured},
                 {"left_out", manifest.left_out},
                 {"simd", column_kernel_target()}};
  for (int band = 0; band < haar.band_count(); ++band) {
    result["bands"].push_back(describe_band(bake, haar, band));
  }
  if (bake.has_curves()) result["curves"] = describe_curves(bake.curve_receivers());
  describe_files(bake.files(), result);
  describe_environments(bake.environments(), result);
  return result;
}

void print(const json& bake, bool verified) {
  std::printf("%s: %s, %d × %d pixels, 6 × %d × %d directions, %.1f MiB%s\n",
              bake["scene"].get<std::string>().c_str(), bake["kind"].get<std::string>().c_str(),
              bake["width"].get<int>(), bake["height"].get<int>(), bake["cube_size"].get<int>(),
              bake["cube_size"].get<int>(), mebibytes(bake["bytes"]),
              verified ? ", every checksum right" : "");
  std::printf(
      "\n  band  columns  left out  density  blocks: float    16-bit     8-bit     4-bit  chroma   "
      "    "
      "MiB\n");
  for (const json& band : bake["bands"]) {
    const json& width = band["blocks_by_width"];
    const auto blocks = std::max<std::size_t>(band["blocks"].get<std::size_t>(), 1);
    const auto luma = band["blocks_by_plane"]["luma"].get<std::size_t>();
    std::printf("  %4d  %7zu  %8zu  %5.1f %%  %13zu %9zu %9zu %9zu  %4.0f %%  %8.1f\n",
                band["band"].get<int>(), band["columns"].get<std::size_t>(),
                band["columns_left_out"].get<std::size_t>(), 100 * band["density"].get<double>(),
                width["float"].get<std::size_t>(), width["16-bit"].get<std::size_t>(),
                width["8-bit"].get<std::size_t>(), width["4-bit"].get<std::size_t>(),
                100 - 100 * static_cast<double>(luma) / static_cast<double>(blocks),
                mebibytes(band["bytes"]));
  }
  if (bake.contains("curves")) print_curves(bake["curves"]);
  print_common(bake);
}

/// `bake` is a bake of any kind, described and printed by its own functions.
template <typename OpenBake, typename Describe, typename Print>
int inspect(const OpenBake& bake, const InspectOptions& options, const Describe& describe_bake,
            const Print& print_bake) {
  if (options.verify) bake.verify();
  json result = describe_bake(bake);
  if (options.verify) result["verified"] = true;
  if (options.json) {
    std::printf("%s\n", result.dump().c_str());
  } else {
    print_bake(result, options.verify);
  }
  return 0;
}

int run(const InspectOptions& options) {
  if (bake_kind(options.folder) == kVertexKind) {
    return inspect(VertexBake(options.folder), options, describe_vertex_bake, print_vertex_bake);
  }
  return inspect(Bake(options.folder), options, describe, print);
}

}  // namespace

void add_inspect_command(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* const command =
      app.add_subcommand("inspect", "Tell what a bake holds and what was left out of it");
  command->add_option("bake", options->folder, "Bake, a NAME.bake folder")->required();
  command->add_flag("--verify", options->verify, "Check every checksum of every file");
  command->add_flag("--json", options->json, "Print the result as one JSON object");
  command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rimlight
