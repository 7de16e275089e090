#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/math/camera.h"
#include "core/transport/bake_files.h"
#include "core/transport/curve_receivers.h"
#include "core/transport/receivers.h"
#include "core/transport/sketch.h"
#include "core/transport/tensor_file.h"
#include "core/transport/tile_transport.h"
#include "core/transport/transport.h"

namespace rimlight {

/// Files of an image bake; docs/formats/bake.md has the tensors of each.
inline constexpr const char* kPixelsFile = "pixels.safetensors";
inline constexpr const char* kSketchFile = "sketch.safetensors";
inline constexpr const char* kCurvesFile = "curves.safetensors";

/// What an image bake holds besides its tensors: manifest.json, written and read through here
/// alone.
struct BakeManifest {
  int version = kBakeVersion;
  std::string kind = kImageKind;
  std::string scene;  // the scene's name
  PixelLayout pixels;
  int cube_size = 0;  // N
  Camera camera;
  // Objects, for people and for inspect: kept as they are.
  nlohmann::json settings = nlohmann::json::object();  // bounces, seed, …: what it was baked with
  nlohmann::json measured = nlohmann::json::object();  // PSNR per check light; blocks per band; …
  nlohmann::json left_out = nlohmann::json::object();  // what is left out, what error that costs
  // Of kind brdf_curve: materials whose direct light is not in the transport but follows their
  // curves, and measured BRDFs to put in their place.
  std::vector<CurveMaterial> materials = {};
  std::vector<CurveMaterial> measured_brdfs = {};
};

/// Writes a bake: everything goes to "NAME.bake.partial/", is flushed, and renamed by commit().
/// Without commit() nothing of the name NAME.bake exists or changes (the partial folder stays, for
/// resuming). Throws Error when the disk refuses. One thread at a time.
class BakeWriter {
 public:
  /// An existing partial folder is kept, so that its parts can be resumed; unless it has a
  /// manifest: then it is what a killed commit() left, and is emptied. Throws Error when another
  /// process writes this bake, or when `folder` exists and is something else than a bake.
  explicit BakeWriter(std::filesystem::path folder);
  ~BakeWriter();
  BakeWriter(const BakeWriter&) = delete;
  BakeWriter& operator=(const BakeWriter&) = delete;

  const std::filesystem::path& partial_folder() const { return partial_; }
  /// A tensor file inside the partial folder; its summary goes to add_file() once finished.
  std::unique_ptr<TensorFileWriter> create(const std::string& file,
                                           const std::vector<TensorShape>& tensors);
  void add_file(const std::string& file, const TensorFileWriter::Summary& summary);

  /// The transport, tile by tile: `tile(t)` is asked twice for each t, from several threads at
  /// once; a few tiles are in memory at a time. Returns the bytes of all runs.
  std::size_t add_transport(std::size_t tile_count,
                            const std::function<TileTransport(std::size_t)>& tile);
  /// What each pixel has beside its row, [height][width]: the share of it that geometry covers, in
  /// [0, 1], kept in 8 bits; and its reflectance (receiver_planes.h), finite, ≥ 0.
  void add_pixels(const PixelLayout& pixels, std::span<const float> coverage,
                  std::span<const Vec3f> reflectance);
  /// Sketches what add_transport() and add_pixels() have written; `sums` are of what it was made
  /// of. Reads all of it back, in parallel.
  void add_sketch(const SketchSums& sums, const PixelLayout& pixels);
  /// What editable materials' direct light is made of, and the factors of measured BRDFs.
  void add_curves(const CurveReceivers& receivers);
  /// At least one; names differ. The first is the default.
  void add_environment(const BakedEnvironment& environment);

  /// Writes the manifest and its hash, removes what does not belong to the bake (parts), flushes,
  /// and renames the folder; an older bake of that name is replaced as a whole.
  void commit(const BakeManifest& manifest);
  /// The same for a bake of another kind, by the fields of its manifest but "version",
  /// "environments" and "files"; add_file() was called for `needed` files.
  void commit(nlohmann::json manifest, std::initializer_list<const char*> needed);

 private:
  class Lock;

  std::filesystem::path folder_;
  std::filesystem::path partial_;
  std::unique_ptr<Lock> lock_;
  std::map<std::string, TensorFileSummary> files_;
  nlohmann::json environments_ = nlohmann::json::array();
};

/// An opened bake of pixels, of kind image_haar or brdf_curve: manifest checked (version, hash,
/// every field), all tensors mapped, hashed and checked. Throws Error naming file and field.
/// Immutable; any thread.
class Bake {
 public:
  explicit Bake(const std::filesystem::path& folder);
  ~Bake();
  Bake(const Bake&) = delete;
  Bake& operator=(const Bake&) = delete;

  const std::filesystem::path& folder() const { return files_.folder(); }
  const BakeManifest& manifest() const { return manifest_; }
  const TransportView& transport() const { return transport_; }
  /// Share of a pixel that geometry covers, in [0, 1]: [height][width].
  const std::vector<float>& coverage() const { return coverage_; }
  /// The reflectance that restore_radiance() takes; padded receivers have 0.
  const ReceiverValues& reflectance() const { return reflectance_; }
  const Sketch& sketch() const { return sketch_; }
  /// Whether sessions edit the curves of its materials (kind brdf_curve).
  bool has_curves() const { return !manifest_.materials.empty(); }
  /// Empty without.
  CurveReceivers curve_receivers() const;
  /// count_column_bytes() of the transport.
  const std::vector<std::uint32_t>& column_bytes() const { return column_bytes_; }
  /// measure_parts() of the transport.
  const std::vector<PartSize>& part_sizes() const { return part_sizes_; }
  const std::vector<BakedEnvironment>& environments() const { return environments_; }
  /// Names and bytes of the files on disk, for inspect.
  std::vector<std::pair<std::string, std::uint64_t>> files() const { return files_.sizes(); }
  /// A file beside those that every bake has; null when this one is without.
  const TensorFile* find_file(const std::string& name) const { return files_.find_file(name); }
  /// Hashes every block of every file afresh; throws Error at the first that is wrong.
  void verify() const { files_.verify(); }

 private:
  BakeFiles files_;
  BakeManifest manifest_;
  TransportView transport_;
  std::vector<float> coverage_;
  std::vector<std::uint32_t> column_bytes_;
  std::vector<PartSize> part_sizes_;
  ReceiverValues reflectance_;
  Sketch sketch_;
  std::vector<CurveSurface> surfaces_;
  SkyVisibilityView visibility_;
  std::vector<BakedEnvironment> environments_;
};

}  // namespace rimlight
