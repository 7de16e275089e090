#include "core/scene/scene_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/scene/mesh_geometry.h"
#include "tests/core/scene/scene_files.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

const fs::path kExamples = "tests/core/scene/examples";

std::size_t triangle_count(const Scene& scene) {
  std::size_t count = 0;
  for (const Mesh& mesh : scene.meshes) count += mesh.triangles.size();
  return count;
}

/// A scene around one object, given as JSON. A probe of eight pixels: the builtin ones take a
/// while.
std::string with_object(const std::string& object) {
  const std::string probe = fs::absolute(kExamples / "good/probe.hdr").string();
  return R"({"camera": {"position": [0, 1, 4], "target": [0, 0, 0]},
             "environments": [{"file": ")" +
         probe + R"("}], "materials": {"grey": {"model": "lambert"}}, "objects": [)" + object +
         "]}";
}

Scene parse(const std::string& text, const fs::path& folder = ".") {
  return parse_scene(text, "scene.json", folder);
}

Bounds bounds_of_object(const std::string& object) {
  return bounds_of(parse(with_object(object)).meshes);
}

/// What every scene promises to those who trace it.
void expect_sound(const Scene& scene) {
  EXPECT_FALSE(scene.name.empty());
  EXPECT_FALSE(scene.environments.empty());
  EXPECT_GT(triangle_count(scene), 0u);
  for (const Mesh& mesh : scene.meshes) {
    ASSERT_LT(mesh.material, scene.materials.size());
    ASSERT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
    for (const auto& t : mesh.triangles) {
      for (const std::uint32_t vertex : t) ASSERT_LT(vertex, mesh.positions.size());
    }
    for (const Vec3f& p : mesh.positions) ASSERT_TRUE(is_finite(p));
    Mesh copy = mesh;
    EXPECT_EQ(drop_degenerate_triangles(copy), 0u);
  }
}

TEST(SceneSource, EveryGoodExampleIsRead) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(kExamples / "good")) {
    if (entry.path().extension() != ".json") continue;
    SCOPED_TRACE(entry.path().string());
    expect_sound(read_scene(entry.path()));
    ++count;
  }
  EXPECT_GE(count, 7);
}

TEST(SceneSource, EveryBadExampleIsRefusedAtItsPointer) {
  std::ifstream list(kExamples / "expected_pointers.txt");
  std::string name;
  std::string pointer;
  std::set<std::string> listed;
  std::string line;
  while (std::getline(list, line)) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    words >> name >> pointer;
    listed.insert(name);
    const std::string path = (kExamples / name).string();
    const std::string where = pointer == "-" ? path + ": found" : path + ": " + pointer + ": ";
    const std::string message = test::error_of([&] { read_scene(path); });
    EXPECT_TRUE(message.starts_with(where)) << message << "\n  should begin with " << where;
  }
  std::size_t files = 0;
  for (const char* folder : {"bad", "bad_beyond_schema"}) {
    for (const auto& entry : fs::directory_iterator(kExamples / folder)) {
      files += listed.count(std::string(folder) + "/" + entry.path().filename().string());
    }
  }
  EXPECT_EQ(files, listed.size());
  EXPECT_GE(files, 60u);
}

TEST(SceneSource, TheDocumentedExampleIsRead) {
  const std::string page = read_file("docs/formats/scene.md", 1 << 20);
  const std::size_t begin = page.find("```json\n");
  ASSERT_NE(begin, std::string::npos);
  const std::size_t end = page.find("```", begin + 8);
  const test::TemporaryFolder folder;
  fs::copy_file(kExamples / "good/tetrahedron.obj", folder / "bunny.obj");
  // A square, as an angular map is.
  std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n";
  for (int i = 0; i < 16; ++i) hdr += "\x80\x80\x80\x81";
  write(folder, "grace_probe.hdr", hdr);
  const Scene scene =
      parse_scene(page.substr(begin + 8, end - begin - 8), "scene.md", folder.path());
  expect_sound(scene);
  EXPECT_EQ(scene.name, "Still life");
  EXPECT_EQ(scene.environments[1].name(), "grace");
  EXPECT_EQ(scene.environments[1].layout(), EnvironmentLayout::angular_map);
  EXPECT_EQ(scene.materials.size(), 4u);
  EXPECT_EQ(scene.dropped_triangles, 1u);
  EXPECT_EQ(scene.bake.cube_size, 32);
}

TEST(SceneSource, TheScenesThatComeAlongAreRead) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator("configs/scenes")) {
    if (entry.path().extension() != ".json") continue;
    expect_sound(read_scene(entry.path()));
    ++count;
  }
  EXPECT_GE(count, 2);
}

TEST(SceneSource, LobesOfTwoAxesArriveWhereTheyBelong) {
  const Scene scene = parse(R"({
    "camera": {"position": [1, 2, 3], "target": [0, 1, 0]},
    "materials": {"a": {"model": "ward", "albedo": 0.1, "specular": 0.2, "roughness": [0.3, 0.4],
                        "tangent": [0, 2, 1]},
                  "b": {"model": "ward", "roughness": 0.5},
                  "c": {"model": "ashikhmin_shirley", "exponent": [6, 7]},
                  "d": {"model": "blinn_phong", "specular": 0.8, "albedo": 0.1, "exponent": 9}},
    "objects": [{"shape": "box", "material": "b"}], "environments": ["studio"]})");
  const Material& a = scene.materials[0];
  EXPECT_EQ(a.brdf.model, BrdfModel::ward);
  EXPECT_EQ(a.brdf.specular, Vec3f::filled(0.2f));
  EXPECT_EQ(a.brdf.roughness, 0.3f);
  EXPECT_EQ(a.brdf.roughness_across, 0.4f);
  EXPECT_EQ(a.tangent, Vec3f(0, 2, 1));
  const Material& b = scene.materials[1];
  EXPECT_EQ(b.brdf.roughness, 0.5f);
  EXPECT_EQ(b.brdf.roughness_across, 0.5f);
  EXPECT_EQ(b.tangent, Vec3f(1, 0, 0));
  const Brdf& c = scene.materials[2].brdf;
  EXPECT_EQ(c.model, BrdfModel::ashikhmin_shirley);
  EXPECT_EQ(c.exponent, 6);
  EXPECT_EQ(c.exponent_across, 7);
  const Brdf& d = scene.materials[3].brdf;
  EXPECT_EQ(d.model, BrdfModel::blinn_phong);
  EXPECT_EQ(d.specular, Vec3f::filled(0.8f));
  EXPECT_EQ(d.exponent, 9);
}

TEST(SceneSource, FieldsArriveWhereTheyBelong) {
  const Scene scene = parse(R"({
    "name": "All", "camera": {"position": [1, 2, 3], "target": [0, 1, 0], "up": [0, 0, -1],
                              "field_of_view": 55},
    "materials": {"a": {"model": "phong", "albedo": [0.1, 0.2, 0.3], "specular": 0.4, "exponent": 7},
                  "b": {"model": "cook_torrance", "roughness": 0.3, "eta": [1, 2, 3], "k": 4}},
    "objects": [{"shape": "box", "material": "b"}], "environments": ["cathedral", "studio"],
    "bake": {"width": 10, "height": 20, "cube_size": 64, "primary_rays": 3, "bounces": 5,
             "psnr_db": 42.5, "seed": 77}})");
  EXPECT_EQ(scene.name, "All");
  EXPECT_EQ(scene.camera.position, Vec3d(1, 2, 3));
  EXPECT_EQ(scene.camera.target, Vec3d(0, 1, 0));
  EXPECT_EQ(scene.camera.up, Vec3d(0, 0, -1));
  EXPECT_EQ(scene.camera.vertical_field_of_view_degrees, 55);
  const Brdf& a = scene.materials[0].brdf;
  EXPECT_EQ(a.model, BrdfModel::phong);
  EXPECT_EQ(a.albedo, Vec3f(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(a.specular, Vec3f::filled(0.4f));
  EXPECT_EQ(a.exponent, 7);
  const Brdf& b = scene.materials[1].brdf;
  EXPECT_EQ(b.model, BrdfModel::cook_torrance);
  EXPECT_EQ(b.albedo, Vec3f());
  EXPECT_EQ(b.specular, Vec3f(1, 1, 1));
  EXPECT_EQ(b.roughness, 0.3f);
  EXPECT_EQ(b.eta, Vec3f(1, 2, 3));
  EXPECT_EQ(b.k, Vec3f::filled(4));
  EXPECT_EQ(scene.meshes[0].material, 1u);
  EXPECT_EQ(scene.environments[0].name(), "cathedral");
  EXPECT_EQ(scene.bake.width, 10);
  EXPECT_EQ(scene.bake.height, 20);
  EXPECT_EQ(scene.bake.cube_size, 64);
  EXPECT_EQ(scene.bake.primary_rays, 3);
  EXPECT_EQ(scene.bake.bounces, 5);
  EXPECT_EQ(scene.bake.psnr_db, 42.5);
  EXPECT_EQ(scene.bake.seed, 77u);
}

/// A scene that is fine but for what is given.
std::string scene_with(const std::string& material, const std::string& bake) {
  return R"({"camera": {"position": [0, 0, 3], "target": [0, 0, 0]},
    "materials": {"m": )" +
         material + R"(}, "objects": [{"shape": "disc", "material": "m"}], "bake": )" + bake + "}";
}

TEST(SceneSource, BakesOfCurvesNameTheMaterialsToEdit) {
  const std::string grey = R"({"model": "lambert"})";
  const BakeSettings bake = parse(scene_with(grey, R"({"kind": "brdf_curve", "cube_size": 8,
        "editable": ["m", "another"], "bounces": 3, "width": 30})"))
                                .bake;
  EXPECT_EQ(bake.kind, BakeKind::brdf_curve);
  EXPECT_EQ(bake.editable, (std::vector<std::string>{"m", "another"}));
  EXPECT_EQ(bake.cube_size, 8);
  EXPECT_EQ(bake.bounces, 3);
  EXPECT_EQ(bake.width, 30);
  EXPECT_TRUE(parse(scene_with(grey, R"({"kind": "brdf_curve"})")).bake.editable.empty());
  for (const auto& [fields, pointer] : std::vector<std::pair<std::string, std::string>>{
           {R"("kind": "brdf_curve", "cube_size": 4)", "/bake/cube_size"},
           {R"("kind": "brdf_curve", "cube_size": 12)", "/bake/cube_size"},
           {R"("kind": "brdf_curve", "editable": [])", "/bake/editable"},
           {R"("kind": "brdf_curve", "editable": "m")", "/bake/editable"},
           {R"("kind": "brdf_curve", "editable": ["m", 3])", "/bake/editable/1"},
           {R"("kind": "brdf_curve", "degree": 3)", "degree"},
           {R"("kind": "image_haar", "editable": ["m"])", "/bake/editable"},
           {R"("editable": ["m"])", "brdf_curve"},
           {R"("kind": "vertex_sh", "editable": ["m"])", "editable"}}) {
    EXPECT_THAT(test::error_of([&, f = fields] { parse(scene_with(grey, "{" + f + "}")); }),
                testing::HasSubstr(pointer))
        << fields;
  }
}

TEST(SceneSource, BakesOfVerticesHaveFieldsOfTheirOwn) {
  const std::string grey = R"({"model": "lambert"})";
  const BakeSettings bake =
      parse(scene_with(grey, R"({"kind": "vertex_sh", "degree": 20, "error": 0.005, "seed": 8,
        "transfer": "shadowed", "most_rays": 64, "keep_bands": true, "longest_edge": 0.25,
        "sun": "directional", "width": 30, "height": 40})"))
          .bake;
  EXPECT_EQ(bake.kind, BakeKind::vertex_sh);
  EXPECT_EQ(bake.vertex.degree, 20);
  EXPECT_EQ(bake.vertex.error, 0.005);
  EXPECT_EQ(bake.vertex.transfer, VertexTransfer::shadowed);
  EXPECT_EQ(bake.vertex.most_rays, 64);
  EXPECT_TRUE(bake.vertex.keep_bands);
  EXPECT_EQ(bake.vertex.longest_edge, 0.25);
  EXPECT_EQ(bake.vertex.sun, SunLight::directional);
  EXPECT_EQ(parse(scene_with(grey, R"({"kind": "vertex_sh", "sun": "harmonics"})")).bake.vertex.sun,
            SunLight::harmonics);
  EXPECT_EQ(parse(scene_with(grey, R"({"kind": "vertex_sh"})")).bake.vertex.sun, std::nullopt);
  EXPECT_EQ(bake.seed, 8u);
  EXPECT_EQ(bake.width, 30);
  EXPECT_EQ(bake.height, 40);
  EXPECT_EQ(parse(scene_with(grey, R"({"kind": "image_haar"})")).bake.kind, BakeKind::image_haar);
  EXPECT_EQ(parse(scene_with(grey, "{}")).bake.kind, BakeKind::image_haar);
  EXPECT_EQ(parse(scene_with(grey, R"({"kind": "vertex_sh"})")).bake.vertex.degree, 10);
  for (const auto& [fields, pointer] : std::vector<std::pair<std::string, std::string>>{
           {R"("kind": "vertex_sh", "degree": 21)", "/bake/degree"},
           {R"("kind": "vertex_sh", "degree": -1)", "/bake/degree"},
           {R"("kind": "vertex_sh", "degree": 1.5)", "/bake/degree"},
           {R"("kind": "vertex_sh", "error": 0)", "/bake/error"},
           {R"("kind": "vertex_sh", "transfer": "all")", "/bake/transfer"},
           {R"("kind": "vertex_sh", "most_rays": 63)", "/bake/most_rays"},
           {R"("kind": "vertex_sh", "keep_bands": 1)", "/bake/keep_bands"},
           {R"("kind": "vertex_sh", "longest_edge": 1.1)", "/bake/longest_edge"},
           {R"("kind": "vertex_sh", "sun": "bright")", "/bake/sun"},
           {R"("kind": "vertex_sh", "cube_size": 32)", "cube_size"},
           {R"("kind": "cloud")", "/bake/kind"},
           {R"("degree": 4)", "degree"}}) {
    EXPECT_THAT(test::error_of([&, f = fields] { parse(scene_with(grey, "{" + f + "}")); }),
                testing::HasSubstr(pointer))
        << fields;
  }
}

TEST(SceneSource, AMaterialMayBeTranslucent) {
  const Scene scene = parse(scene_with(
      R"({"model": "phong", "subsurface": {"absorption": [0, 0.5, 2], "scattering": 7, "eta": 1.5}})",
      "{}"));
  ASSERT_TRUE(scene.materials[0].subsurface.has_value());
  EXPECT_EQ(scene.materials[0].subsurface->absorption, Vec3f(0, 0.5f, 2));
  EXPECT_EQ(scene.materials[0].subsurface->scattering, Vec3f::filled(7));
  EXPECT_EQ(scene.materials[0].subsurface->eta, 1.5f);
  for (const char* const bad : {R"({"absorption": 1})", R"({"absorption": -1, "scattering": 1})",
                                R"({"absorption": 1, "scattering": 0})",
                                R"({"absorption": 1, "scattering": 1, "eta": 0.9})"}) {
    EXPECT_THAT(test::error_of([&] {
                  parse(scene_with(
                      std::string(R"({"model": "lambert", "subsurface": )") + bad + "}", "{}"));
                }),
                testing::HasSubstr("subsurface"))
        << bad;
  }
}

TEST(SceneSource, WhatIsLeftOutHasItsDefault) {
  const Scene scene = parse(R"({"camera": {"position": [0, 0, 3], "target": [0, 0, 0]},
    "materials": {"m": {"model": "lambert"}}, "objects": [{"shape": "disc", "material": "m"}]})");
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.camera.up, Vec3d(0, 1, 0));
  EXPECT_EQ(scene.environments.size(), 3u);
  EXPECT_EQ(scene.environments[0].name(), "sunny");
  EXPECT_EQ(scene.bake.width, 512);
  EXPECT_EQ(scene.bake.psnr_db, 50);
}

TEST(SceneSource, ObjectsArePlacedByScaleRotateFitTranslateInThisOrder) {
  // A box of 1 × 2 × 4, doubled along x, turned by 90° about x: 2 × 4 × 2 with y and z exchanged.
  const std::string box = R"({"shape": "box", "size": [1, 2, 4], "material": "grey")";
  const Bounds turned = bounds_of_object(box + R"(, "scale": [2, 1, 1], "rotate": [90, 0, 0]})");
  EXPECT_LT(length(turned.high - Vec3d(1, 2, 1)), 1e-6);
  const Bounds fitted = bounds_of_object(
      box + R"(, "rotate": [90, 0, 0], "fit": {"height": 8}, "translate": [10, 5, 0]})");
  EXPECT_LT(length(fitted.low - Vec3d(9, 5, -2)), 1e-5);
  EXPECT_LT(length(fitted.high - Vec3d(11, 13, 2)), 1e-5);
  const Bounds longest = bounds_of_object(box + R"(, "fit": {"longest": 1}})");
  EXPECT_LT(length(longest.high - Vec3d(0.125, 0.5, 0.5)), 1e-6);
  // x first: z goes to −y by −90° … seen from +x, y turns to z.
  const Bounds two = bounds_of_object(box + R"(, "rotate": [90, 90, 0]})");
  EXPECT_LT(length(two.high - Vec3d(1, 2, 0.5)), 1e-6);
  const Bounds axis = bounds_of_object(
      R"({"shape": "cone", "material": "grey", "rotate": {"axis": [0, 0, 2], "angle": -90}})");
  EXPECT_NEAR(axis.high.x, 1, 1e-6);  // its tip, once at +y
  EXPECT_NEAR(axis.low.x, 0, 1e-6);
}

TEST(SceneSource, AFilesOwnMaterialsAreUsedUnlessTheObjectNamesOne) {
  const test::TemporaryFolder folder;
  write(folder, "m.mtl", "newmtl leaf\nKd 0.1 0.6 0.2\n");
  write(folder, "m.obj", "mtllib m.mtl\nusemtl leaf\nv 0 0 0\nv 2 0 0\nv 2 1 0\nf 1 2 3\n");
  const Scene scene = parse(
      with_object(R"({"file": "m.obj"}, {"file": "m.obj", "material": "grey"})"), folder.path());
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_LT(length(scene.materials[scene.meshes[0].material].brdf.albedo - Vec3f(0.1f, 0.6f, 0.2f)),
            1e-6f);
  EXPECT_EQ(scene.materials[scene.meshes[1].material].name, "grey");
}

TEST(SceneSource, BadMeshFilesAreNamedWithFileAndPointer) {
  const test::TemporaryFolder folder;
  write(folder, "flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_EQ(test::error_of([&] { parse(with_object(R"({"file": "flat.obj"})"), folder.path()); }),
            "scene.json: /objects/0: found only degenerate triangles, expected a surface");
  write(folder, "bad.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
  const std::string bad =
      test::error_of([&] { parse(with_object(R"({"file": "bad.ply"})"), folder.path()); });
  EXPECT_TRUE(bad.starts_with("scene.json: /objects/0/file: ")) << bad;
  EXPECT_NE(bad.find("bad.ply"), std::string::npos) << bad;
}

TEST(SceneSource, CommentsAreAllowedAndMalformedJsonIsNot) {
  EXPECT_EQ(parse("// what\n" + with_object(R"({"shape": "box", /* why */ "material": "grey"})"))
                .meshes.size(),
            1u);
  EXPECT_NE(test::error_of([] { parse("{\"objects\": [}"); }).find("line 1, column"),
            std::string::npos);
  EXPECT_NE(test::error_of([] { read_scene("no/such/scene.json"); }).find("no/such/scene.json"),
            std::string::npos);
}

TEST(SceneSource, ABuiltinCanBeJoinedByObjectsAndSeenFromElsewhere) {
  const Scene scene = parse(R"({"camera": {"position": [9, 9, 9], "target": [0, 0, 0]},
    "environments": ["studio"],
    "materials": {"m": {"model": "lambert", "albedo": 0.9}},
    "objects": [{"shape": "sphere", "material": "m"}, {"builtin": "terrace"}]})");
  expect_sound(scene);
  EXPECT_EQ(scene.camera.position, Vec3d(9, 9, 9));
  EXPECT_EQ(scene.environments.size(), 1u);
  EXPECT_EQ(scene.meshes[0].material, 0u);
  EXPECT_GT(scene.meshes[1].material, 0u);
}

TEST(SceneSource, RealFilesMakeScenes) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << "RIMLIGHT_DATA is not set";
  const Scene bunny =
      parse(with_object(R"({"file": "meshes/bunny.obj", "normals": "smooth", "fit": {"height": 1},
                      "material": "grey"})"),
            *data);
  expect_sound(bunny);
  EXPECT_EQ(triangle_count(bunny) + bunny.dropped_triangles, 69'451u);
  EXPECT_NEAR(bounds_of(bunny.meshes).high.y, 1, 1e-6);
  EXPECT_NEAR(bounds_of(bunny.meshes).low.y, 0, 1e-6);
  const Scene box = parse(with_object(R"({"file": "scenes/cornellBox/cornellBox.gltf"})"), *data);
  expect_sound(box);
  EXPECT_EQ(box.dropped_triangles, 508u);
}

}  // namespace
}  // namespace rimlight
