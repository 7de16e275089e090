#include "core/transport/bake_folder.h"
#include "core/transport/part_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/math/random.h"
#include "core/transport/bake_manifest.h"
#include "tests/support/forged_bake.h"
#include "tests/support/overwrite.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;
using test::forge_file;
using test::forge_manifest;
using test::TemporaryFolder;

std::string read(const fs::path& path) { return read_file(path, SIZE_MAX); }

/// What opening says, or "" when it opens.
std::string error_of_opening(const fs::path& folder) {
  try {
    Bake(folder).verify();
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(BakeFolder, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  const test::SmallBake settings;
  test::write_small_bake(folder / "a.bake", settings);
  const Bake bake(folder / "a.bake");
  bake.verify();
  EXPECT_EQ(bake.manifest().scene, "small");
  EXPECT_EQ(bake.manifest().pixels.width, 70);
  EXPECT_EQ(bake.manifest().pixels.height, 66);
  EXPECT_EQ(bake.manifest().cube_size, 4);
  EXPECT_EQ(bake.manifest().camera.position, Vec3d(1, 2, 6));
  EXPECT_EQ(bake.manifest().settings["seed"], 1);
  EXPECT_EQ(bake.manifest().measured["psnr_db"], 51.5);
  EXPECT_EQ(bake.manifest().left_out["blocks"], 7);
  const auto coverage = test::small_coverage(settings);
  ASSERT_EQ(bake.coverage().size(), coverage.size());
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    ASSERT_NEAR(bake.coverage()[i], coverage[i], 0.5 / 255 + 1e-6);
    ASSERT_EQ(bake.coverage()[i] == 1, coverage[i] == 1);
  }
  const auto tiles = test::small_tiles(settings);
  ASSERT_EQ(bake.transport().tile_count(), tiles.size());
  const Transport expected(tiles);
  const auto& found_arrays = bake.transport().arrays();
  const auto& arrays = expected.view().arrays();
  EXPECT_TRUE(std::ranges::equal(found_arrays.column_step, arrays.column_step));
  EXPECT_TRUE(std::ranges::equal(found_arrays.tile_first_word, arrays.tile_first_word));
  EXPECT_TRUE(std::ranges::equal(found_arrays.run_offset, arrays.run_offset));
  EXPECT_TRUE(std::ranges::equal(found_arrays.runs, arrays.runs));
  EXPECT_GT(arrays.runs.size(), 0u);
  const auto reflectance = test::small_reflectance(settings);
  for (std::size_t i = 0; i < reflectance.size(); ++i) {
    const std::size_t receiver =
        settings.pixels.receiver(static_cast<int>(i % 70), static_cast<int>(i / 70));
    ASSERT_EQ(bake.reflectance().at(receiver), reflectance[i]);
  }
}

TEST(BakeFolder, KeepsEnvironmentsBitForBit) {
  const TemporaryFolder folder;
  test::write_small_bake(folder / "a.bake", {});
  const Bake bake(folder / "a.bake");
  const auto expected = test::small_environments();
  ASSERT_EQ(bake.environments().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const BakedEnvironment& found = bake.environments()[i];
    EXPECT_EQ(found.environment->name(), expected[i].environment->name());
    EXPECT_EQ(found.environment->layout(), expected[i].environment->layout());
    EXPECT_EQ(found.exposure_scale, expected[i].exposure_scale);
    EXPECT_EQ(found.environment->image().width, expected[i].environment->image().width);
    EXPECT_EQ(found.environment->image().pixels, expected[i].environment->image().pixels);
  }
}

TEST(BakeFolder, TheSameBakeHasTheSameBytes) {
  const TemporaryFolder folder;
  test::write_small_bake(folder / "a.bake", {});
  test::write_small_bake(folder / "b.bake", {});
  const Bake bake(folder / "a.bake");
  EXPECT_GE(bake.files().size(), 6u);
  for (const auto& [name, bytes] : bake.files()) {
    EXPECT_EQ(read(folder / "a.bake" / name), read(folder / "b.bake" / name)) << name;
    EXPECT_EQ(bytes, fs::file_size(folder / "a.bake" / name)) << name;
  }
}

TEST(BakeFolder, AFlippedBitInAnyFileIsAnErrorThatNamesTheFile) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake";
  test::write_small_bake(path, {});
  ASSERT_EQ(error_of_opening(path), "");
  Random random(11);
  int files = 0;
  for (const auto& entry : fs::directory_iterator(path)) {
    ++files;
    const std::string name = entry.path().filename().string();
    const std::string good = read(entry.path());
    for (int i = 0; i < 25; ++i) {
      std::string bad = good;
      char& byte = bad[random.below(bad.size())];
      byte = static_cast<char>(byte ^ (1 << random.below(8)));
      test::overwrite(entry.path(), bad);
      EXPECT_THAT(error_of_opening(path),
                  testing::HasSubstr("manifest.json.xxh64" == name ? "manifest.json" : name));
    }
    test::overwrite(entry.path(), good);
  }
  EXPECT_EQ(files, 7);
  EXPECT_EQ(error_of_opening(path), "");
}

TEST(BakeFolder, ATruncatedOrMissingFileIsAnErrorThatNamesIt) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake";
  test::write_small_bake(path, {});
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(path)) files.push_back(entry.path());
  for (const fs::path& file : files) {
    const std::string name = file.filename().string(), good = read(file);
    for (const std::size_t size : {std::size_t{0}, good.size() / 2, good.size() - 1}) {
      test::overwrite(file, good.substr(0, size));
      EXPECT_THAT(error_of_opening(path),
                  testing::HasSubstr("manifest.json.xxh64" == name ? "manifest.json" : name));
    }
    fs::remove(file);
    EXPECT_THAT(error_of_opening(path), testing::HasSubstr(name));
    test::overwrite(file, good);
  }
  EXPECT_EQ(error_of_opening(path), "");
  EXPECT_NE(error_of_opening(folder / "none.bake"), "");
}

TEST(BakeFolder, AManifestFieldThatIsNotAsPromisedIsNamed) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake";
  test::write_small_bake(path, {});
  const auto good = nlohmann::json::parse(read(path / kManifestFile));
  struct Change {
    const char* pointer;
    nlohmann::json value;
    const char* named;
  };
  const auto null = nlohmann::json();
  const std::vector<Change> changes = {
      {"/version", 2, "/version"},
      {"/version", "2", "/version"},
      {"/kind", "vertex_sh", "/kind"},
      {"/scene", 3, "/scene"},
      {"/width", 0, "/width"},
      {"/width", 100000, "/width"},
      {"/width", 71, ""},  // still four tiles: the coverage does not fit
      {"/width", 700, "tile_first_word"},
      {"/height", -1, "/height"},
      {"/cube_size", 5, "/cube_size"},
      {"/cube_size", 8, "column_step"},
      {"/cube_size", 4096, "/cube_size"},
      {"/camera/position", {0, 0}, "/camera/position"},
      {"/camera/target", {1, 2, 6}, "/camera"},
      {"/camera/up", {1e300, 0, 0}, "/camera/up/0"},
      {"/camera/vertical_field_of_view_degrees", 180, "/camera/vertical"},
      {"/camera/lens", 50, "lens"},
      {"/settings", null, "/settings"},
      {"/more", 1, "more"},
      {"/environments", nlohmann::json::array(), "/environments"},
      {"/environments/0/file", "no.safetensors", "no.safetensors"},
      {"/environments/0/file", "transport.safetensors", "radiance"},
      {"/environments/0/name", "room", "/environments/1/name"},
      {"/environments/0/layout", "automatic", "/environments/0/layout"},
      {"/environments/0/exposure_scale", 0, "/environments/0/exposure_scale"},
      {"/environments/0/exposure_scale", "1", "/environments/0/exposure_scale"},
      {"/files/transport.safetensors/bytes", 5000000, "/files/transport.safetensors"},
      {"/files/transport.safetensors/xxh64/0", "0", "/files/transport.safetensors/xxh64/0"},
      {"/files/pixels.safetensors", null, "/files/pixels.safetensors"},
      {"/files/..~1evil", {{"bytes", 0}, {"xxh64", nlohmann::json::array()}}, "/files/..~1evil"},
      {"/files", nlohmann::json::object(), "transport.safetensors"},
  };
  for (const Change& change : changes) {
    auto manifest = good;
    manifest[nlohmann::json::json_pointer(change.pointer)] = change.value;
    forge_manifest(path, manifest.dump());
    const std::string error = error_of_opening(path);
    EXPECT_NE(error, "") << change.pointer << " " << change.value;
    EXPECT_THAT(error, testing::HasSubstr(change.named)) << change.pointer;
    EXPECT_THAT(error, testing::HasSubstr("a.bake"));
  }
  for (const auto& [name, value] : good.items()) {
    auto manifest = good;
    manifest.erase(name);
    forge_manifest(path, manifest.dump());
    EXPECT_THAT(error_of_opening(path), testing::HasSubstr("\"" + name + "\""));
  }
  for (const char* text : {"", "[]", "{", "null"}) {
    forge_manifest(path, text);
    EXPECT_THAT(error_of_opening(path), testing::HasSubstr(kManifestFile)) << text;
  }
  forge_manifest(path, good.dump());
  EXPECT_EQ(error_of_opening(path), "");
}

TEST(BakeFolder, TheDocumentsExampleIsAManifestWithAllFields) {
  const std::string page = read("docs/formats/bake.md");
  const std::string fence = "```json\n";
  const std::size_t begin = page.find(fence) + fence.size();
  const std::string text = page.substr(begin, page.find("```", begin) - begin);
  const nlohmann::json json = parse_json(text, "docs/formats/bake.md");
  const JsonReader reader(json, "docs/formats/bake.md");
  const nlohmann::json understood = manifest_to_json(read_manifest(reader));
  EXPECT_EQ(understood.size() + 2, json.size());  // and environments, and files
  for (const auto& [name, value] : understood.items()) {
    EXPECT_EQ(json[name], value) << name;
  }
  int files = 0;
  for (const auto& [name, summary] : reader.member("files").members()) {
    EXPECT_TRUE(is_plain_file_name(name));
    EXPECT_EQ(TensorFileSummary::from_json(summary).to_json(), summary.value());
    ++files;
  }
  EXPECT_EQ(files, 4);
  for (const JsonReader& environment : reader.member("environments").elements(1)) {
    EXPECT_EQ(read_layout(environment.member("layout")), EnvironmentLayout::lat_long);
  }
}

/// The bytes of a tensor file of transport with something changed, its hashes right.
using Edit = std::function<void(TileTransport&)>;
enum Which { second_tile, all_tiles };
std::string error_of_forged_transport(const fs::path& path, const fs::path& scratch, Which which,
                                      const Edit& edit) {
  auto tiles = test::small_tiles({});
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    if (which == all_tiles || t == 1) edit(tiles[t]);
  }
  {
    BakeWriter writer(scratch);
    writer.add_transport(tiles.size(), [&](std::size_t t) { return tiles[t]; });
    forge_file(path, kTransportFile, read(writer.partial_folder() / kTransportFile));
  }
  return error_of_opening(path);
}

TEST(BakeFolder, TransportThatWouldLeadTheKernelAstrayIsRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake", scratch = folder / "b.bake";
  test::write_small_bake(path, {});
  const auto error = [&](const Edit& edit) {
    return error_of_forged_transport(path, scratch, second_tile, edit);
  };
  ASSERT_EQ(error([](TileTransport&) {}), "");
  EXPECT_THAT(error([](TileTransport& t) { t.runs[0] += 1; }), testing::HasSubstr("runs[1]["));
  EXPECT_THAT(error([](TileTransport& t) { t.runs[1] |= 0xffff000000000000; }),
              testing::HasSubstr("counts"));
  EXPECT_THAT(error([](TileTransport& t) { t.run_offset[0] = 1; }),
              testing::HasSubstr("run_offset"));
  EXPECT_THAT(error([](TileTransport& t) { t.run_offset.back() += 1; }),
              testing::HasSubstr("run_offset"));
  EXPECT_THAT(error([](TileTransport& t) { t.run_offset[40] = 0xffffffff; }),
              testing::HasSubstr("run_offset"));
  for (const float bad : {std::numeric_limits<float>::infinity(), -1.0f}) {
    EXPECT_THAT(error_of_forged_transport(path, scratch, all_tiles,
                                          [bad](TileTransport& t) { t.column_step[9] = bad; }),
                testing::HasSubstr("column_step[9]"));
  }
}

TEST(BakeFolder, ReflectanceThatIsNoneIsRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake";
  test::write_small_bake(path, {});
  for (const float bad :
       {std::numeric_limits<float>::infinity(), -1.0f, std::numeric_limits<float>::quiet_NaN()}) {
    std::string bytes = read(path / kPixelsFile);
    std::memcpy(bytes.data() + bytes.size() - sizeof bad, &bad, sizeof bad);
    forge_file(path, kPixelsFile, bytes);
    EXPECT_THAT(error_of_opening(path), testing::HasSubstr("\"reflectance\""));
  }
}

TEST(BakeFolder, EnvironmentsThatAreNotRadianceAreRefused) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake";
  test::write_small_bake(path, {});
  const std::string good = read(path / "environment_0.safetensors");
  for (const float bad :
       {std::numeric_limits<float>::infinity(), -1.0f, std::numeric_limits<float>::quiet_NaN()}) {
    std::string bytes = good;
    std::memcpy(bytes.data() + bytes.size() - sizeof bad, &bad, sizeof bad);
    forge_file(path, "environment_0.safetensors", bytes);
    EXPECT_THAT(error_of_opening(path), testing::HasSubstr("environment_0.safetensors: pixel 127"));
  }
  TensorFileWriter writer(path / "environment_0.safetensors",
                          {{"radiance", ElementType::f32, {8, 16, 4}}});
  writer.append(std::span<const float>(std::vector<float>(8 * 16 * 4)));
  writer.finish();
  forge_file(path, "environment_0.safetensors", read(path / "environment_0.safetensors"));
  EXPECT_THAT(error_of_opening(path), testing::HasSubstr("shape [8, 16, 4]"));
}

TEST(Part, ComesBackAndOnlyForItsOwnFingerprint) {
  const TemporaryFolder folder;
  const auto tile = test::small_tiles({}).front();
  const fs::path path = folder / "tile-0.part";
  EXPECT_FALSE(load_part(path, tile.column_count(), 5).has_value());
  save_part(path, tile, 5);
  const auto back = load_part(path, tile.column_count(), 5);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(*back, tile);
  EXPECT_FALSE(load_part(path, tile.column_count(), 6).has_value());
  EXPECT_FALSE(load_part(path, tile.column_count() + 1, 5).has_value());
}

TEST(Part, OfWhichAnyBitIsFlippedOrMissingIsNotLoaded) {
  const TemporaryFolder folder;
  const auto tile = test::small_tiles({}).front();
  const fs::path path = folder / "tile-0.part";
  save_part(path, tile, 5);
  Random random(2);
  for (const fs::path& file : {path, fs::path(path.string() + ".json")}) {
    const std::string good = read(file);
    for (int i = 0; i < 100; ++i) {
      std::string bad = good;
      char& byte = bad[random.below(bad.size())];
      byte = static_cast<char>(byte ^ (1 << random.below(8)));
      test::overwrite(file, bad);
      EXPECT_FALSE(load_part(path, tile.column_count(), 5).has_value()) << file << " " << i;
    }
    test::overwrite(file, good.substr(0, good.size() / 2));
    EXPECT_FALSE(load_part(path, tile.column_count(), 5).has_value());
    fs::remove(file);
    EXPECT_FALSE(load_part(path, tile.column_count(), 5).has_value());
    test::overwrite(file, good);
    EXPECT_TRUE(load_part(path, tile.column_count(), 5).has_value());
  }
}

}  // namespace
}  // namespace rimlight
