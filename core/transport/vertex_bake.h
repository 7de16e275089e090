#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/math/camera.h"
#include "core/transport/bake_files.h"
#include "core/transport/bake_folder.h"
#include "core/transport/vertex_transport.h"

namespace rimlight {

/// Transport of vertices is baked to this degree at most.
inline constexpr int kLargestVertexDegree = 20;

/// docs/formats/vertex_bake.md has the tensors of each.
inline constexpr const char* kMeshFile = "mesh.safetensors";

/// What a bake of vertices holds besides its mesh and transport.
struct VertexBakeManifest {
  std::string scene;  // the scene's name
  int width = 0;      // of the picture that the scene asks for, in pixels
  int height = 0;
  Camera camera;
  std::vector<VertexMaterial> materials;
  // Objects, for people and for inspect: kept as they are.
  nlohmann::json settings = nlohmann::json::object();
  nlohmann::json measured = nlohmann::json::object();
  nlohmann::json left_out = nlohmann::json::object();
};

/// Writes mesh, transport and manifest, and commits; environments were added before. CheckFailure
/// when mesh, materials and transport do not fit each other.
void commit_vertex_bake(BakeWriter& writer, const VertexBakeManifest& manifest,
                        const VertexMesh& mesh, const VertexTransportView& transport);

/// An opened bake of vertices (kind "vertex_sh"): manifest checked (version, kind, hash, every
/// field), tensors hashed and checked: shapes, indices, finite numbers, unit normals; vertices
/// beyond the highlight_count have no highlight. Throws Error naming file and field or tensor.
/// Immutable; any thread.
class VertexBake {
 public:
  explicit VertexBake(const std::filesystem::path& folder);
  VertexBake(const VertexBake&) = delete;
  VertexBake& operator=(const VertexBake&) = delete;

  const std::filesystem::path& folder() const { return files_.folder(); }
  const VertexBakeManifest& manifest() const { return manifest_; }
  const std::string& scene() const { return manifest_.scene; }
  const VertexMesh& mesh() const { return mesh_; }
  const std::vector<VertexMaterial>& materials() const { return manifest_.materials; }
  /// A view of memory that this bake keeps.
  const VertexTransportView& transport() const { return transport_; }
  const Camera& camera() const { return manifest_.camera; }
  int width() const { return manifest_.width; }
  int height() const { return manifest_.height; }
  const std::vector<BakedEnvironment>& environments() const { return environments_; }
  const nlohmann::json& settings() const { return manifest_.settings; }
  const nlohmann::json& measured() const { return manifest_.measured; }
  const nlohmann::json& left_out() const { return manifest_.left_out; }
  /// Names and bytes of the files on disk.
  const std::vector<std::pair<std::string, std::uint64_t>>& files() const { return files_.sizes(); }
  /// Hashes every block of every file afresh; throws Error at the first that is wrong.
  void verify() const { files_.verify(); }

 private:
  BakeFiles files_;
  VertexBakeManifest manifest_;
  VertexMesh mesh_;
  VertexTransportView transport_;
  std::vector<BakedEnvironment> environments_;
};

}  // namespace rimlight
