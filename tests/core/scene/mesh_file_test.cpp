#include "core/scene/mesh_file.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/scene/mesh_geometry.h"
#include "tests/core/scene/scene_files.h"

namespace rimlight {
namespace {

std::size_t triangle_count(const MeshFile& file) {
  std::size_t count = 0;
  for (const Mesh& mesh : file.meshes) count += mesh.triangles.size();
  return count;
}

/// The Error that reading the file throws; fails the test when it throws none.
Error error_of(const std::filesystem::path& path) {
  try {
    read_mesh_file(path, FileMaterials::read);
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << path << " was read";
  return Error("", "", "");
}

/// A glTF of one triangle under two nested nodes, its numbers in a buffer of its own.
std::string gltf_triangle(const test::TemporaryFolder& folder, const std::vector<float>& positions,
                          const std::vector<std::uint16_t>& indices) {
  std::string bytes(positions.size() * 4 + indices.size() * 2, '\0');
  std::memcpy(bytes.data(), positions.data(), positions.size() * 4);
  std::memcpy(bytes.data() + positions.size() * 4, indices.data(), indices.size() * 2);
  write(folder, "triangle.bin", bytes);
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"children": [1], "translation": [10, 0, 0]},
              {"mesh": 0, "scale": [2, 2, 2], "rotation": [0, 0, 0.70710678, 0.70710678]}],
    "materials": [{"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.1, 0.2, 1]}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                   "min": [0, 0, 0], "max": [1, 1, 0]},
                  {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
    "buffers": [{"uri": "triangle.bin", "byteLength": 42}]})";
}

TEST(MeshFile, ReadsAnObjWithItsMaterialAndTriangulatesIt) {
  const test::TemporaryFolder folder;
  write(folder, "m.mtl", "newmtl leaf\nKd 0.1 0.6 0.2\n");
  const auto path = write(folder, "m.obj",
                          "mtllib m.mtl\nusemtl leaf\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n"
                          "v 0.5 0.5 0\nf 1 2 3 4\n");
  const MeshFile file = read_mesh_file(path, FileMaterials::read);
  EXPECT_EQ(triangle_count(file), 2u);
  const Vec3f albedo = file.materials[file.meshes[0].material].brdf.albedo;
  EXPECT_LT(length(albedo - Vec3f(0.1f, 0.6f, 0.2f)), 1e-6f);
}

TEST(MeshFile, AppliesTheNodesOfAGltf) {
  const test::TemporaryFolder folder;
  const std::string json = gltf_triangle(folder, {0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2});
  const MeshFile file = read_mesh_file(write(folder, "t.gltf", json), FileMaterials::read);
  ASSERT_EQ(triangle_count(file), 1u);
  const Bounds bounds = bounds_of(file.meshes);
  // (1, 0, 0) is doubled, turned to +y and moved by 10; (0, 1, 0) is turned to −x.
  EXPECT_LT(length(bounds.low - Vec3d(8, 0, 0)), 1e-5);
  EXPECT_LT(length(bounds.high - Vec3d(10, 2, 0)), 1e-5);
  const Vec3f albedo = file.materials[file.meshes[0].material].brdf.albedo;
  EXPECT_LT(length(albedo - Vec3f(0.8f, 0.1f, 0.2f)), 1e-6f);
}

TEST(MeshFile, RefusesWhatIsNotFiniteOrOutOfRange) {
  const test::TemporaryFolder folder;
  const auto nan = write(folder, "nan.ply",
                         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                         "property float y\nproperty float z\nelement face 1\n"
                         "property list uchar int vertex_indices\nend_header\n"
                         "0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n");
  EXPECT_NE(std::string(error_of(nan).what()).find("nan.ply"), std::string::npos);
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n";
  const float positions[9] = {0, 0, 0, 1, 0, 0, 0, std::numeric_limits<float>::infinity(), 0};
  binary.append(reinterpret_cast<const char*>(positions), sizeof positions);
  const std::int32_t face[3] = {0, 1, 2};
  binary.append("\x03").append(reinterpret_cast<const char*>(face), sizeof face);
  EXPECT_EQ(error_of(write(folder, "inf.ply", binary)).expected(), "finite coordinates");

  const std::string json = gltf_triangle(folder, {0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 77});
  const Error range = error_of(write(folder, "range.gltf", json));
  EXPECT_NE(range.where().find("range.gltf"), std::string::npos);
}

TEST(MeshFile, RefusesMissingMalformedEmptyAndForeignFiles) {
  const test::TemporaryFolder folder;
  EXPECT_NE(error_of(folder.path() / "none.obj").found().find("No such file"), std::string::npos);
  EXPECT_EQ(error_of(write(folder, "a.stl", "solid")).found(), "the ending \".stl\"");
  EXPECT_NE(std::string(error_of(write(folder, "bad.gltf", "{\"asset\":")).what()).find("bad.gltf"),
            std::string::npos);
  error_of(write(folder, "bad.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"));
  error_of(write(folder, "points.obj", "v 0 0 0\nv 1 0 0\n"));
  error_of(write(folder, "empty.obj", ""));
  // assimp does not return from a header without an end, nor doubt what one claims.
  error_of(write(folder, "claim.ply",
                 "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n"
                 "property float x\nproperty float y\nproperty float z\nend_header\n"));
}

TEST(MeshFile, TruncationAnywhereIsAnErrorOrAMesh) {
  const test::TemporaryFolder folder;
  const std::string json = gltf_triangle(folder, {0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2});
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n";
  const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  ply.append(reinterpret_cast<const char*>(positions), sizeof positions);
  const std::int32_t face[3] = {0, 1, 2};
  ply.append("\x03").append(reinterpret_cast<const char*>(face), sizeof face);
  const std::string ascii =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
  const std::pair<const char*, std::string> files[] = {
      {"t.gltf", json}, {"b.ply", ply}, {"a.ply", ascii}, {"o.obj", obj}};
  for (const auto& [name, bytes] : files) {
    int errors = 0;
    for (std::size_t size = 0; size < bytes.size(); size += 5) {
      const auto path = write(folder, name, std::string_view(bytes).substr(0, size));
      try {
        EXPECT_LE(triangle_count(read_mesh_file(path, FileMaterials::read)), 1u);
      } catch (const Error&) {
        ++errors;
      }
    }
    // All but a shorter index at the very end, which OBJ and text cannot tell from a whole one.
    EXPECT_GE(5 * (errors + 2), static_cast<int>(bytes.size())) << name;
    EXPECT_EQ(triangle_count(read_mesh_file(write(folder, name, bytes), FileMaterials::read)), 1u);
  }
}

TEST(MeshFile, AMissingTextureIsNamedUnlessMaterialsAreIgnored) {
  const test::TemporaryFolder folder;
  write(folder, "t.mtl", "newmtl a\nKd 1 1 1\nmap_Kd absent.png\n");
  const auto path =
      write(folder, "t.obj",
            "mtllib t.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
  EXPECT_NE(std::string(error_of(path).what()).find("absent.png"), std::string::npos);
  EXPECT_EQ(triangle_count(read_mesh_file(path, FileMaterials::ignore)), 1u);
}

struct RealFile {
  const char* name;
  std::size_t triangles;
  std::size_t degenerate;
};

TEST(MeshFile, RealMeshesHaveTheTrianglesTheyAreKnownToHave) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << "RIMLIGHT_DATA is not set";
  const RealFile files[] = {{"meshes/bunny.obj", 69'451, 0},
                            {"meshes/lucy100k_binary.ply", 100'000, 0},
                            {"meshes/armadillo.obj", 86'482, 0},
                            // One of its meshes, of 12 triangles, is shown twice. 380 have no
                            // area, and 128 a height of 2e-7 of their length.
                            {"scenes/cornellBox/cornellBox.gltf", 16'720 + 12, 380 + 128},
                            {"scenes/small_city/scene.gltf", 36'930, 0}};
  for (const RealFile& known : files) {
    MeshFile file = read_mesh_file(*data / known.name, FileMaterials::read);
    EXPECT_EQ(triangle_count(file), known.triangles) << known.name;
    std::size_t dropped = 0;
    for (Mesh& mesh : file.meshes) dropped += drop_degenerate_triangles(mesh);
    EXPECT_EQ(dropped, known.degenerate) << known.name;
  }
}

TEST(MeshFile, RealTexturesAreRead) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << "RIMLIGHT_DATA is not set";
  const MeshFile city = read_mesh_file(*data / "scenes/small_city/scene.gltf", FileMaterials::read);
  int textured = 0;
  for (const Mesh& mesh : city.meshes) {
    const Material& material = city.materials[mesh.material];
    if (!material.albedo_texture) continue;
    ++textured;
    EXPECT_EQ(mesh.texture_coordinates.size(), mesh.positions.size());
    EXPECT_GT(material.albedo_texture->width, 1);
  }
  EXPECT_GT(textured, 0);
}

}  // namespace
}  // namespace rimlight
