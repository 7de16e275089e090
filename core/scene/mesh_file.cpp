#include "core/scene/mesh_file.h"

#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "core/base/error.h"
#include "core/image/image_file.h"
#include "core/image/tone_map.h"
#include "core/scene/ply_check.h"
#include "core/scene/transform.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

/// Deeper trees are no scene graphs.
constexpr std::size_t kDeepestNode = 10'000;

void check_file(const fs::path& path) {
  std::error_code error;
  const auto size = fs::file_size(path, error);
  if (error) throw Error(path.string(), error.message(), "a mesh file");
  if (size > kLargestMeshFile) {
    throw Error(path.string(), std::to_string(size) + " bytes",
                "at most " + std::to_string(kLargestMeshFile) + " bytes");
  }
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending != ".obj" && ending != ".ply" && ending != ".gltf" && ending != ".glb") {
    throw Error(path.string(), "the ending " + quote(ending), ".obj, .ply, .gltf or .glb");
  }
  if (ending == ".ply") check_ply(path);
}

/// Whether an index has to be looked at before assimp triangulates: it reads what they point to.
void check_mesh(const aiMesh& mesh, const std::string& where) {
  if (mesh.mNumVertices > 0 && mesh.mVertices == nullptr) {
    throw Error(where, "no positions", "a position for each vertex");
  }
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& p = mesh.mVertices[i];
    if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) {
      throw Error(
          where + ", vertex " + std::to_string(i),
          "(" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z) + ")",
          "finite coordinates");
    }
  }
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      if (face.mIndices[k] < mesh.mNumVertices) continue;
      throw Error(where + ", face " + std::to_string(f),
                  "vertex " + std::to_string(face.mIndices[k]),
                  "a vertex below " + std::to_string(mesh.mNumVertices));
    }
  }
}

std::string mesh_name(const fs::path& path, const aiScene& scene, unsigned index) {
  const std::string name = scene.mMeshes[index]->mName.C_Str();
  return path.string() + ": mesh " + std::to_string(index) +
         (name.empty() ? "" : " " + quote(name));
}

/// The raw data, checked, then triangulated.
const aiScene& import(Assimp::Importer& importer, const fs::path& path) {
  const aiScene* scene = importer.ReadFile(path.string(), 0);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    const std::string reason = importer.GetErrorString();
    throw Error(path.string(), reason.empty() ? "no mesh" : quote(reason),
                "a well-formed OBJ, PLY or glTF 2.0 file");
  }
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
    check_mesh(*scene->mMeshes[i], mesh_name(path, *scene, i));
  }
  scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  if (scene == nullptr) {
    throw Error(path.string(), quote(importer.GetErrorString()), "faces that can be triangulated");
  }
  return *scene;
}

Transform transform_of(const aiMatrix4x4& m) {
  Transform result;
  result.linear = {{{m.a1, m.a2, m.a3}, {m.b1, m.b2, m.b3}, {m.c1, m.c2, m.c3}}};
  result.offset = {m.a4, m.b4, m.c4};
  return result;
}

bool is_finite_direction(const aiVector3D& n) {
  return std::isfinite(n.x) && std::isfinite(n.y) && std::isfinite(n.z);
}

/// Normals that are given are made unit; a broken one is set to zero, and rays that hit it use the
/// triangle's own.
Vec3f normal_of(const aiVector3D& n) {
  if (!is_finite_direction(n)) return {};
  const double size = length(Vec3d(n.x, n.y, n.z));
  return size > 0 ? Vec3f(Vec3d(n.x, n.y, n.z) / size) : Vec3f();
}

Mesh convert(const aiMesh& source, const std::string& where) {
  Mesh mesh;
  mesh.name = source.mName.C_Str();
  mesh.material = source.mMaterialIndex;
  mesh.positions.reserve(source.mNumVertices);
  for (unsigned i = 0; i < source.mNumVertices; ++i) {
    mesh.positions.emplace_back(source.mVertices[i].x, source.mVertices[i].y,
                                source.mVertices[i].z);
  }
  if (source.HasNormals()) {
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      mesh.normals.push_back(normal_of(source.mNormals[i]));
    }
  }
  if (source.HasTextureCoords(0)) {
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      const aiVector3D& t = source.mTextureCoords[0][i];
      if (!is_finite_direction(t)) {
        throw Error(where + ", vertex " + std::to_string(i), "a texture coordinate not finite",
                    "finite texture coordinates");
      }
      mesh.texture_coordinates.push_back({t.x, t.y});
    }
  }
  for (unsigned f = 0; f < source.mNumFaces; ++f) {
    const aiFace& face = source.mFaces[f];
    if (face.mNumIndices != 3) continue;  // points and lines
    mesh.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
  }
  return mesh;
}

/// Walks the node tree without recursion: a hostile file may nest as deep as it likes.
std::vector<Mesh> collect_meshes(const aiScene& scene, const fs::path& path) {
  struct Place {
    const aiNode* node;
    Transform transform;
    std::size_t depth;
  };
  std::vector<Place> open{{scene.mRootNode, {}, 0}};
  std::vector<Mesh> meshes;
  std::size_t triangles = 0;
  while (!open.empty()) {
    const Place place = open.back();
    open.pop_back();
    if (place.depth > kDeepestNode) {
      throw Error(path.string(), "nodes nested more than " + std::to_string(kDeepestNode) + " deep",
                  "a scene graph");
    }
    const Transform world = place.transform * transform_of(place.node->mTransformation);
    for (unsigned i = 0; i < place.node->mNumMeshes; ++i) {
      const unsigned index = place.node->mMeshes[i];
      triangles += scene.mMeshes[index]->mNumFaces;
      if (triangles > kMostTriangles) {
        throw Error(path.string(), "more than " + std::to_string(kMostTriangles) + " triangles",
                    "fewer");
      }
      Mesh mesh = convert(*scene.mMeshes[index], mesh_name(path, scene, index));
      if (mesh.triangles.empty()) continue;
      apply(world, mesh);
      meshes.push_back(std::move(mesh));
    }
    // Last child first, so that the first one is popped first: the file's order.
    for (unsigned i = place.node->mNumChildren; i-- > 0;) {
      open.push_back({place.node->mChildren[i], world, place.depth + 1});
    }
  }
  if (meshes.empty()) throw Error(path.string(), "no triangles", "at least one triangle");
  return meshes;
}

/// Texels that a file holds uncompressed, as 8-bit sRGB.
RgbImage raw_texture(const aiTexture& texture, const std::string& where) {
  if (texture.mWidth > kLargestImageSide || texture.mHeight > kLargestImageSide) {
    throw Error(where, std::to_string(texture.mWidth) + " × " + std::to_string(texture.mHeight),
                "sides up to " + std::to_string(kLargestImageSide));
  }
  std::array<float, 256> linear;
  for (std::size_t i = 0; i < linear.size(); ++i) {
    linear[i] = static_cast<float>(linear_from_srgb(static_cast<double>(i) / 255));
  }
  RgbImage image(static_cast<int>(texture.mWidth), static_cast<int>(texture.mHeight));
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const aiTexel& texel = texture.pcData[i];
    image.pixels[i] = {linear[texel.r], linear[texel.g], linear[texel.b]};
  }
  return image;
}

/// Reads each texture once, however many materials show it.
class TextureReader {
 public:
  TextureReader(const aiScene& scene, fs::path path) : scene_(scene), path_(std::move(path)) {}

  std::shared_ptr<const RgbImage> read(const std::string& name) {
    auto& image = images_[name];
    if (!image) image = std::make_shared<const RgbImage>(load(name));
    return image;
  }

 private:
  RgbImage load(const std::string& name) const {
    const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str());
    if (embedded == nullptr) return read_srgb_picture(path_.parent_path() / name);
    const std::string where = path_.string() + ": texture " + quote(name);
    if (embedded->mHeight != 0) return raw_texture(*embedded, where);
    return decode_srgb_picture(embedded->pcData, embedded->mWidth, where);
  }

  const aiScene& scene_;
  fs::path path_;
  std::map<std::string, std::shared_ptr<const RgbImage>> images_;
};

Vec3f base_colour(const aiMaterial& material, const std::string& where) {
  aiColor4D colour(0.5f, 0.5f, 0.5f, 1);
  if (material.Get(AI_MATKEY_BASE_COLOR, colour) != aiReturn_SUCCESS) {
    material.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
  }
  for (const float c : {colour.r, colour.g, colour.b}) {
    if (!(c >= 0 && c <= 1)) {
      throw Error(where, "the colour component " + std::to_string(c), "a number from 0 to 1");
    }
  }
  return {colour.r, colour.g, colour.b};
}

std::vector<Material> convert_materials(const aiScene& scene, const fs::path& path) {
  TextureReader textures(scene, path);
  std::vector<Material> materials;
  for (unsigned i = 0; i < scene.mNumMaterials; ++i) {
    const aiMaterial& source = *scene.mMaterials[i];
    aiString name;
    source.Get(AI_MATKEY_NAME, name);
    Material material;
    material.name = path.filename().string() + ": " + name.C_Str();
    material.brdf.albedo = base_colour(source, path.string() + ": material " + quote(name.C_Str()));
    aiString texture;
    if (source.GetTexture(aiTextureType_BASE_COLOR, 0, &texture) == aiReturn_SUCCESS ||
        source.GetTexture(aiTextureType_DIFFUSE, 0, &texture) == aiReturn_SUCCESS) {
      material.albedo_texture = textures.read(texture.C_Str());
    }
    materials.push_back(std::move(material));
  }
  return materials;
}

}  // namespace

MeshFile read_mesh_file(const fs::path& path, FileMaterials materials) {
  check_file(path);
  Assimp::Importer importer;
  const aiScene& scene = import(importer, path);
  MeshFile result;
  result.meshes = collect_meshes(scene, path);
  if (materials == FileMaterials::read) result.materials = convert_materials(scene, path);
  if (result.materials.empty()) {
    result.materials.push_back({path.filename().string(), Brdf{}, nullptr});
    for (Mesh& mesh : result.meshes) mesh.material = 0;
  }
  for (const Mesh& mesh : result.meshes) {
    if (mesh.material >= result.materials.size()) {
      throw Error(path.string(), "material " + std::to_string(mesh.material),
                  "a material below " + std::to_string(result.materials.size()));
    }
  }
  return result;
}

}  // namespace rimlight
