#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/command.h"
#include "core/basis/cube_haar.h"
#include "core/transport/bake_folder.h"
#include "core/transport/column_kernel.h"

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

/// A name as JSON escapes it, without the quotes: nothing in it moves the cursor.
std::string printable(const std::string& name) {
  const std::string quoted = json(name).dump();
  return quoted.substr(1, quoted.size() - 2);
}

/// A JSON object's members, a line each; whatever they are.
void print_members(const char* title, const json& object) {
  std::printf("\n  %s:\n", title);
  for (const auto& [name, value] : object.items()) {
    if (!value.is_object()) {
      std::printf("    %-28s %s\n", printable(name).c_str(), value.dump().c_str());
      continue;
    }
    for (const auto& [of, part] : value.items()) {
      std::printf("    %-28s %s\n", printable(name + ", " + of).c_str(), part.dump().c_str());
    }
  }
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
  std::uint64_t bytes = 0;
  for (const auto& [name, size] : bake.files()) {
    result["files"].push_back({{"file", name}, {"bytes", size}});
    bytes += size;
  }
  result["bytes"] = bytes;
  for (const BakedEnvironment& one : bake.environments()) {
    result["environments"].push_back({{"name", one.environment->name()},
                                      {"width", one.environment->image().width},
                                      {"height", one.environment->image().height},
                                      {"exposure_scale", one.exposure_scale}});
  }
  return result;
}

double mebibytes(const json& bytes) { return bytes.get<double>() / (1 << 20); }

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
  std::printf("\n  file                        MiB\n");
  for (const json& file : bake["files"]) {
    std::printf("  %-24s %8.1f\n", file["file"].get<std::string>().c_str(),
                mebibytes(file["bytes"]));
  }
  std::printf("\n  environments:");
  for (const json& one : bake["environments"]) {
    std::printf(" %s (%d × %d)", one["name"].get<std::string>().c_str(), one["width"].get<int>(),
                one["height"].get<int>());
  }
  std::printf("\n");
  print_members("left out, and what that costs", bake["left_out"]);
  print_members("measured", bake["measured"]);
  print_members("settings", bake["settings"]);
}

int run(const InspectOptions& options) {
  const Bake bake(options.folder);
  if (options.verify) bake.verify();
  json result = describe(bake);
  if (options.verify) result["verified"] = true;
  if (options.json) {
    std::printf("%s\n", result.dump().c_str());
  } else {
    print(result, options.verify);
  }
  return 0;
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
