#include "core/transport/vertex_bake.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>

#include "core/base/files.h"
#include "core/math/random.h"
#include "core/transport/bake_manifest.h"
#include "core/transport/vertex_bake_manifest.h"
#include "tests/support/error_of.h"
#include "tests/support/overwrite.h"
#include "tests/support/small_bake.h"
#include "tests/support/small_vertex_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::TemporaryFolder;
using test::VertexBakeParts;
using ::testing::HasSubstr;

std::string read(const fs::path& path) { return read_file(path, SIZE_MAX); }

std::string error_of_opening(const fs::path& folder) {
  return error_of([&] { VertexBake(folder).verify(); });
}

/// What opening says of a bake that a writer was given these parts for.
std::string error_with(const std::function<void(VertexBakeParts&)>& edit) {
  const TemporaryFolder folder;
  VertexBakeParts parts = test::small_vertex_parts({});
  edit(parts);
  test::write_vertex_bake(folder / "a.bake", parts);
  return error_of_opening(folder / "a.bake");
}

/// What opening says of a bake whose manifest was edited, its hash right.
std::string error_with_manifest(const std::function<void(nlohmann::json&)>& edit) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake";
  test::write_vertex_bake(path, test::small_vertex_parts({}));
  auto json = nlohmann::json::parse(read(path / kManifestFile));
  edit(json);
  test::overwrite(path / kManifestFile, json.dump());
  test::overwrite(path / kManifestHashFile, manifest_hash_line(json.dump()));
  return error_of_opening(path);
}

void expect_same(const VertexBake& bake, const VertexBakeParts& parts) {
  EXPECT_EQ(bake.mesh().positions, parts.mesh.positions);
  EXPECT_EQ(bake.mesh().normals, parts.mesh.normals);
  EXPECT_EQ(bake.mesh().tints, parts.mesh.tints);
  EXPECT_EQ(bake.mesh().materials, parts.mesh.materials);
  EXPECT_EQ(bake.mesh().triangles, parts.mesh.triangles);
  const VertexTransportView& view = bake.transport();
  EXPECT_EQ(view.vertex_count, parts.view.vertex_count);
  EXPECT_EQ(view.highlight_count, parts.view.highlight_count);
  EXPECT_EQ(view.irradiance_degree, parts.view.irradiance_degree);
  EXPECT_EQ(view.visibility_degree, parts.view.visibility_degree);
  EXPECT_EQ(view.irradiance_channels, parts.view.irradiance_channels);
  EXPECT_TRUE(std::ranges::equal(view.irradiance, parts.view.irradiance));
  EXPECT_TRUE(std::ranges::equal(view.visibility, parts.view.visibility));
  ASSERT_EQ(bake.materials().size(), parts.manifest.materials.size());
  for (std::size_t i = 0; i < bake.materials().size(); ++i) {
    EXPECT_EQ(bake.materials()[i].name, parts.manifest.materials[i].name);
    EXPECT_EQ(bake.materials()[i].albedo, parts.manifest.materials[i].albedo);
    EXPECT_EQ(bake.materials()[i].highlight, parts.manifest.materials[i].highlight);
    EXPECT_EQ(bake.materials()[i].exponent, parts.manifest.materials[i].exponent);
  }
}

TEST(VertexBake, GivesBackWhatWasWritten) {
  for (const std::size_t highlights : {std::size_t{0}, std::size_t{64}, std::size_t{150}}) {
    const TemporaryFolder folder;
    const VertexBakeParts parts = test::small_vertex_parts({.highlights = highlights});
    test::write_vertex_bake(folder / "a.bake", parts);
    const VertexBake bake(folder / "a.bake");
    bake.verify();
    expect_same(bake, parts);
    EXPECT_EQ(bake.folder(), folder / "a.bake");
    EXPECT_EQ(bake.scene(), "strip");
    EXPECT_EQ(bake.width(), 320);
    EXPECT_EQ(bake.height(), 200);
    EXPECT_EQ(bake.camera().position, Vec3d(1, 2, 6));
    EXPECT_EQ(bake.settings(), parts.manifest.settings);
    EXPECT_EQ(bake.measured(), parts.manifest.measured);
    EXPECT_EQ(bake.left_out(), parts.manifest.left_out);
    ASSERT_EQ(bake.environments().size(), 2u);
    EXPECT_EQ(bake.environments()[1].environment->name(), "room");
    EXPECT_EQ(bake.environments()[1].exposure_scale, 1.25);
    ASSERT_EQ(bake.files().size(), 6u);
    for (const auto& [name, bytes] : bake.files()) {
      EXPECT_EQ(bytes, fs::file_size(folder / "a.bake" / name)) << name;
    }
  }
}

TEST(VertexBake, KindsAreToldApart) {
  const TemporaryFolder folder;
  test::write_vertex_bake(folder / "vertices.bake", test::small_vertex_parts({}));
  test::write_small_bake(folder / "image.bake", {});
  EXPECT_EQ(bake_kind(folder / "vertices.bake"), kVertexKind);
  EXPECT_EQ(bake_kind(folder / "image.bake"), kImageKind);
  EXPECT_THAT(error_of_opening(folder / "image.bake"),
              HasSubstr("/kind: found \"image_haar\", expected \"vertex_sh\""));
  EXPECT_THAT(
      error_of([&] { Bake(folder / "vertices.bake"); }),
      HasSubstr("/kind: found \"vertex_sh\", expected one of \"image_haar\" \"brdf_curve\""));
  EXPECT_THAT(error_of([&] { static_cast<void>(bake_kind(folder / "none.bake")); }),
              HasSubstr("found no folder"));
}

TEST(VertexBake, AFlippedBitInAnyFileIsAnErrorThatNamesTheFile) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.bake";
  test::write_vertex_bake(path, test::small_vertex_parts({}));
  ASSERT_EQ(error_of_opening(path), "no error");
  Random random(11);
  int files = 0;
  for (const auto& entry : fs::directory_iterator(path)) {
    ++files;
    const std::string name = entry.path().filename().string();
    const std::string good = read(entry.path());
    for (int i = 0; i < 20; ++i) {
      std::string bad = good;
      char& byte = bad[random.below(bad.size())];
      byte = static_cast<char>(byte ^ (1 << random.below(8)));
      test::overwrite(entry.path(), bad);
      EXPECT_THAT(error_of_opening(path),
                  HasSubstr(kManifestHashFile == name ? kManifestFile : name));
    }
    test::overwrite(entry.path(), good);
  }
  EXPECT_EQ(files, 6);
  EXPECT_EQ(error_of_opening(path), "no error");
}

TEST(VertexBake, TensorsThatWouldLeadTheRelighterAstrayAreRefused) {
  ASSERT_EQ(error_with([](VertexBakeParts&) {}), "no error");
  const auto error = error_with;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  EXPECT_THAT(error([](VertexBakeParts& p) { p.mesh.triangles[9][2] = 150; }),
              HasSubstr("\"triangles\", row 9: found vertex 150, expected one of 150"));
  EXPECT_THAT(error([](VertexBakeParts& p) { p.mesh.positions[7].y = kInfinity; }),
              HasSubstr("\"positions\", row 7"));
  EXPECT_THAT(error([](VertexBakeParts& p) { p.mesh.positions[7].z = std::nanf(""); }),
              HasSubstr("\"positions\", row 7"));
  EXPECT_THAT(error([](VertexBakeParts& p) {
                p.mesh.normals[8] = {0, 0, 1.01f};
              }),
              HasSubstr("\"normals\", row 8"));
  EXPECT_THAT(error([](VertexBakeParts& p) { p.mesh.normals[8].x = std::nanf(""); }),
              HasSubstr("\"normals\", row 8"));
  EXPECT_THAT(error([](VertexBakeParts& p) { p.mesh.tints[6].x = -0.1f; }),
              HasSubstr("\"tints\", row 6"));
  EXPECT_THAT(error([](VertexBakeParts& p) { p.mesh.materials[3] = 2; }),
              HasSubstr("\"materials\", row 3: found material 2"));
  EXPECT_THAT(error([](VertexBakeParts& p) { p.mesh.materials[70] = 1; }),
              HasSubstr("\"materials\", row 70: found a material with a highlight"));
  EXPECT_THAT(error([](VertexBakeParts& p) { p.irradiance[65] = 0x7c00; }),
              HasSubstr("\"irradiance\", row 1: found a number that is not finite"));
  EXPECT_THAT(error([](VertexBakeParts& p) { p.visibility[2] = 0xfe01; }),
              HasSubstr("\"visibility\", row 0"));
  EXPECT_THAT(error([](VertexBakeParts& p) { p.irradiance.back() = 1; }),
              HasSubstr("found a number in the padding"));
  EXPECT_THAT(error([](VertexBakeParts& p) { p.visibility.back() = 1; }),
              HasSubstr("found a number in the padding"));
}

TEST(VertexBake, ManifestsThatDoNotFitAreRefusedNamingTheField) {
  using nlohmann::json;
  ASSERT_EQ(error_with_manifest([](json&) {}), "no error");
  const TemporaryFolder folder;
  test::write_vertex_bake(folder / "a.bake", test::small_vertex_parts({}));
  const json good = json::parse(read(folder / "a.bake" / kManifestFile));
  for (const auto& item : good.items()) {
    EXPECT_THAT(error_with_manifest([&](json& m) { m.erase(item.key()); }),
                HasSubstr("\"" + item.key() + "\""));
  }
  EXPECT_THAT(error_with_manifest([](json& m) { m["colour"] = 1; }), HasSubstr("colour"));
  EXPECT_THAT(error_with_manifest([](json& m) { m["version"] = 4; }), HasSubstr("/version"));
  EXPECT_THAT(error_with_manifest([](json& m) { m["kind"] = "cloud"; }), HasSubstr("/kind"));
  struct Case {
    const char* field;
    json value;
    const char* expected;
  };
  for (const Case& one :
       {Case{"irradiance_degree", 21, "/irradiance_degree"},
        Case{"visibility_degree", -1, "/visibility_degree"},
        Case{"irradiance_channels", 2, "/irradiance_channels"},
        Case{"highlight_vertices", 151, "/highlight_vertices"}, Case{"vertices", 0, "/vertices"},
        Case{"triangles", 0, "/triangles"}, Case{"materials", json::array(), "/materials"},
        // Of the right kind, but not what the tensors are.
        Case{"vertices", 4294967295, "\"positions\""},
        Case{"triangles", 4294967296, "\"triangles\""},
        Case{"irradiance_degree", 20, "\"irradiance\""},
        Case{"visibility_degree", 2, "\"visibility\""},
        Case{"irradiance_channels", 1, "\"irradiance\""}}) {
    EXPECT_THAT(error_with_manifest([&](json& m) { m[one.field] = one.value; }),
                HasSubstr(one.expected))
        << one.field << one.value;
  }
  EXPECT_THAT(error_with_manifest([](json& m) { m["materials"][1]["exponent"] = 0.5; }),
              HasSubstr("/materials/1/exponent"));
  EXPECT_THAT(error_with_manifest([](json& m) { m["materials"][0]["albedo"][2] = 1.5; }),
              HasSubstr("/materials/0/albedo"));
  EXPECT_THAT(error_with_manifest([](json& m) { m["files"].erase(kMeshFile); }),
              HasSubstr(kMeshFile));
}

TEST(VertexBake, TheDocumentsExampleIsAManifestWithAllFields) {
  const std::string page = read("docs/formats/vertex_bake.md");
  const std::string fence = "```json\n";
  const std::size_t begin = page.find(fence) + fence.size();
  const auto json =
      parse_json(page.substr(begin, page.find("```", begin) - begin), "vertex_bake.md");
  const JsonReader reader(json, "vertex_bake.md");
  const nlohmann::json understood =
      to_json(read_vertex_manifest(reader), read_vertex_shape(reader));
  EXPECT_EQ(understood.size() + 3, json.size());  // and version, environments, files
  for (const auto& [name, value] : understood.items()) EXPECT_EQ(json[name], value) << name;
  EXPECT_EQ(reader.member("files").members().size(), 3u);
}

}  // namespace
}  // namespace rimlight
