// Bakes of kind brdf_curve, written and read back.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/files.h"
#include "core/transport/bake_folder.h"
#include "core/transport/curve_tensors.h"
#include "tests/support/small_curve_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::CurveBakeParts;
using test::TemporaryFolder;

std::string read(const fs::path& path) { return read_file(path, SIZE_MAX); }

void expect_same(const CurveMaterial& found, const CurveMaterial& expected) {
  EXPECT_EQ(found.name, expected.name);
  EXPECT_EQ(found.brdf.model, expected.brdf.model);
  EXPECT_EQ(found.brdf.albedo, expected.brdf.albedo);
  EXPECT_EQ(found.brdf.specular, expected.brdf.specular);
  EXPECT_EQ(found.brdf.exponent, expected.brdf.exponent);
  EXPECT_EQ(found.brdf.exponent_across, expected.brdf.exponent_across);
  EXPECT_EQ(found.brdf.roughness, expected.brdf.roughness);
  EXPECT_EQ(found.brdf.roughness_across, expected.brdf.roughness_across);
  EXPECT_EQ(found.brdf.eta, expected.brdf.eta);
  EXPECT_EQ(found.brdf.k, expected.brdf.k);
  ASSERT_EQ(found.measured.has_value(), expected.measured.has_value());
  EXPECT_EQ(found.measured_name, expected.measured_name);
  if (!found.measured) return;
  EXPECT_EQ(found.measured->half_angle, expected.measured->half_angle);
  EXPECT_EQ(found.measured->difference_angle, expected.measured->difference_angle);
  EXPECT_EQ(found.measured->rest, expected.measured->rest);
  EXPECT_EQ(found.measured->error.logarithmic, expected.measured->error.logarithmic);
  EXPECT_EQ(found.measured->error.relative, expected.measured->error.relative);
  EXPECT_EQ(found.measured->valid_share, expected.measured->valid_share);
}

void expect_same(const CurveSurface& found, const CurveSurface& expected) {
  EXPECT_EQ(found.receiver, expected.receiver);
  EXPECT_EQ(found.material, expected.material);
  EXPECT_EQ(found.share, expected.share);
  EXPECT_EQ(found.tint, expected.tint);
  for (std::size_t q = 0; q < kSurfacePoints; ++q) {
    EXPECT_EQ(found.points[q].normal, expected.points[q].normal);
    EXPECT_EQ(found.points[q].tangent, expected.points[q].tangent);
    EXPECT_EQ(found.points[q].geometric_normal, expected.points[q].geometric_normal);
    EXPECT_EQ(found.points[q].outgoing, expected.points[q].outgoing);
  }
}

TEST(CurveBake, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  const CurveBakeParts parts;
  write_curve_bake(folder / "a.bake", parts);
  const Bake bake(folder / "a.bake");
  bake.verify();
  EXPECT_EQ(bake_kind(folder / "a.bake"), kCurveKind);
  EXPECT_EQ(bake.manifest().kind, kCurveKind);
  ASSERT_TRUE(bake.has_curves());
  const CurveReceivers found = bake.curve_receivers();
  ASSERT_EQ(found.materials.size(), parts.manifest.materials.size());
  for (std::size_t i = 0; i < found.materials.size(); ++i) {
    expect_same(found.materials[i], parts.manifest.materials[i]);
  }
  ASSERT_EQ(found.measured.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    expect_same(found.measured[i], parts.manifest.measured_brdfs[i]);
  }
  ASSERT_EQ(found.surfaces.size(), parts.surfaces.size());
  ASSERT_EQ(found.visibility.surface_count(), parts.surfaces.size());
  std::vector<std::uint8_t> fifths(parts.fifths.front().size());
  for (std::size_t i = 0; i < found.surfaces.size(); ++i) {
    expect_same(found.surfaces[i], parts.surfaces[i]);
    found.visibility.unpack(i, fifths);
    EXPECT_EQ(fifths, parts.fifths[i]);
  }
}

TEST(CurveBake, NeedsNoMeasuredBrdfAndABakeOfImagesHasNoCurves) {
  const TemporaryFolder folder;
  CurveBakeParts parts;
  parts.manifest.measured_brdfs.clear();
  parts.manifest.materials.back().measured.reset();
  write_curve_bake(folder / "a.bake", parts);
  const Bake bake(folder / "a.bake");
  EXPECT_TRUE(bake.curve_receivers().measured.empty());
  EXPECT_FALSE(bake.curve_receivers().surfaces.empty());
  test::write_small_bake(folder / "b.bake", {});
  const Bake image(folder / "b.bake");
  EXPECT_FALSE(image.has_curves());
  EXPECT_TRUE(image.curve_receivers().surfaces.empty());
  EXPECT_EQ(image.curve_receivers().visibility.surface_count(), 0u);
}

TEST(CurveBake, TheDocumentsExampleHasAllFields) {
  const std::string page = read("docs/formats/bake.md"), fence = "```json\n";
  const std::size_t begin = page.rfind(fence) + fence.size();
  const json example =
      parse_json(page.substr(begin, page.find("```", begin) - begin), "docs/formats/bake.md");
  const JsonReader reader(example, "docs/formats/bake.md");
  EXPECT_EQ(curve_materials_to_json(read_curve_materials(reader.member("materials"))),
            example["materials"]);
  EXPECT_EQ(measured_to_json(read_measured(reader.member("measured_brdfs"))),
            example["measured_brdfs"]);
}

}  // namespace
}  // namespace rimlight
