#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/base/json_reader.h"
#include "core/light/environment.h"
#include "core/transport/tensor_file.h"

namespace rimlight {

inline constexpr int kBakeVersion = 3;

/// Files that every bake has; docs/formats/bake.md has the tensors of each kind's others.
inline constexpr const char* kManifestFile = "manifest.json";
inline constexpr const char* kManifestHashFile = "manifest.json.xxh64";
inline constexpr const char* kTransportFile = "transport.safetensors";

/// The kinds of bakes, as manifests name them: pixels of one view and Haar functions on a cube map,
/// and the same with materials whose curves are edited (class Bake); vertices and spherical
/// harmonics (class VertexBake).
inline constexpr const char* kImageKind = "image_haar";
inline constexpr const char* kCurveKind = "brdf_curve";
inline constexpr const char* kVertexKind = "vertex_sh";

/// An environment as a bake keeps it: its image, as it was read or made, and the exposure that
/// shows the bake well in it.
struct BakedEnvironment {
  std::shared_ptr<const Environment> environment;
  double exposure_scale = 1;  // stops = 0 multiplies radiance by this
};

/// The kind of the bake in a folder, by its manifest, whose hash is checked. Throws Error when
/// there is no bake, or one of another version or of a kind that is not known here.
std::string bake_kind(const std::filesystem::path& folder);

/// What bakes of all kinds have in common: a folder with a manifest that matches its hash, and the
/// tensor files that it lists, mapped. Throws Error naming file and field. Immutable; any thread.
class BakeFiles {
 public:
  explicit BakeFiles(const std::filesystem::path& folder);
  BakeFiles(const BakeFiles&) = delete;
  BakeFiles& operator=(const BakeFiles&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  /// The whole manifest, for its kind's reader to check.
  JsonReader manifest() const { return {manifest_, path(kManifestFile)}; }
  /// A file's name for errors.
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  const TensorFile& file(const std::string& name) const;
  /// Null when the bake is without.
  const TensorFile* find_file(const std::string& name) const;
  /// Names and bytes of the files on disk.
  const std::vector<std::pair<std::string, std::uint64_t>>& sizes() const { return sizes_; }
  /// The environments that the manifest lists, at least one, their images read and checked.
  std::vector<BakedEnvironment> read_environments() const;
  /// Hashes every block of every file afresh; throws Error at the first that is wrong.
  void verify() const;

 private:
  BakedEnvironment read_environment(const JsonReader& json) const;

  std::filesystem::path folder_;
  nlohmann::json manifest_;
  std::map<std::string, TensorFile> files_;
  std::vector<std::pair<std::string, std::uint64_t>> sizes_;
};

}  // namespace rimlight
