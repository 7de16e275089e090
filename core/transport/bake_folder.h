#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/light/environment.h"
#include "core/math/camera.h"
#include "core/transport/receivers.h"
#include "core/transport/tensor_file.h"
#include "core/transport/transport.h"

namespace rimlight {

inline constexpr int kBakeVersion = 1;

/// An environment as a bake keeps it: its image, as it was read or made, and the exposure that
/// shows the bake well in it.
struct BakedEnvironment {
  std::shared_ptr<const Environment> environment;
  double exposure_scale = 1;  // stops = 0 multiplies radiance by this
};

/// What a bake holds besides its tensors: manifest.json, written and read through here alone.
struct BakeManifest {
  int version = kBakeVersion;
  std::string kind = "image_haar";
  std::string scene;  // the scene's name
  PixelLayout pixels;
  int cube_size = 0;  // N
  Camera camera;
  nlohmann::json settings;  // bounces, primary rays, seed, …: what it was baked with
  nlohmann::json measured;  // per check light: PSNR in dB; blocks kept per band; seconds; …
  nlohmann::json left_out;  // what was left out and what error that costs
};

/// Writes a bake: everything goes to "NAME.bake.partial/", is flushed, and renamed by commit().
/// Without commit() nothing of the name NAME.bake exists (the partial folder stays, for resuming).
class BakeWriter {
 public:
  /// An existing partial folder is kept: its parts can be resumed. Throws Error.
  explicit BakeWriter(std::filesystem::path folder);

  const std::filesystem::path& partial_folder() const { return partial_; }
  /// A tensor file inside the partial folder; its summary goes to add_file() once finished.
  std::unique_ptr<TensorFileWriter> create(const std::string& file,
                                           std::vector<TensorShape> tensors);
  void add_file(const std::string& file, const TensorFileWriter::Summary& summary);
  void add_environment(const BakedEnvironment& environment);
  /// Writes the manifest and its hash, removes what does not belong to the bake (parts), flushes,
  /// and renames the folder; an older bake of that name is replaced as a whole.
  void commit(const BakeManifest& manifest);

 private:
  std::filesystem::path folder_;
  std::filesystem::path partial_;
  nlohmann::json files_;
  nlohmann::json environments_;
};

/// An opened bake: manifest checked (version, hash, every field), tensors mapped.
/// Throws Error naming file and field. Immutable; any thread.
class Bake {
 public:
  explicit Bake(const std::filesystem::path& folder);
  ~Bake();

  const std::filesystem::path& folder() const { return folder_; }
  const BakeManifest& manifest() const { return manifest_; }
  const TransportView& transport() const { return transport_; }
  /// Share of a pixel that geometry covers, in [0, 1]: [height][width].
  const std::vector<float>& coverage() const { return coverage_; }
  const std::vector<BakedEnvironment>& environments() const { return environments_; }
  /// Bytes of each file on disk, for inspect.
  std::vector<std::pair<std::string, std::uint64_t>> files() const;
  /// Hashes every block of every file; throws Error at the first that is wrong.
  void verify() const;

 private:
  std::filesystem::path folder_;
  BakeManifest manifest_;
  TransportView transport_;
  std::vector<float> coverage_;
  std::vector<BakedEnvironment> environments_;
  std::vector<std::unique_ptr<TensorFile>> files_;
  std::vector<std::pair<std::string, std::uint64_t>> file_sizes_;
};

}  // namespace rimlight
