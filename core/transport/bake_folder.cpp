#include "core/transport/bake_folder.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/parallel.h"
#include "core/basis/cube_map.h"
#include "core/image/image_file.h"
#include "core/transport/bake_manifest.h"
#include "core/transport/bake_tensors.h"

namespace rimlight {
namespace {

constexpr std::size_t kMostFiles = 4096;
constexpr std::size_t kMostImagePixels = std::size_t{1} << 28;

}  // namespace

Bake::Bake(const std::filesystem::path& folder) : folder_(folder) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw Error(folder.string(), "no folder", "a bake");
  }
  const std::string text = read_manifest_text(folder);
  const std::string source = (folder / kManifestFile).string();
  const nlohmann::json json = parse_json(text, source);
  const JsonReader reader(json, source);
  manifest_ = read_manifest(reader);
  const JsonReader files = reader.member("files");
  for (const auto& [name, summary] : files.members()) {
    if (!is_plain_file_name(name)) summary.fail("a plain file name");
    if (files_.size() == kMostFiles) files.fail("at most " + std::to_string(kMostFiles) + " files");
    files_.emplace(name, TensorFile(folder / name, TensorFileSummary::from_json(summary)));
  }
  file_sizes_ = {{kManifestFile, text.size()},
                 {kManifestHashFile, manifest_hash_line(text).size()}};
  for (const auto& item : files_) file_sizes_.emplace_back(item.first, item.second.byte_count());
  const auto path = [this](const char* name) { return (folder_ / name).string(); };
  const std::size_t columns = cube::texel_count(manifest_.cube_size);
  transport_ = read_transport(file(kTransportFile), path(kTransportFile),
                              manifest_.pixels.tile_count(), columns);
  column_bytes_ = count_column_bytes(transport_);
  part_sizes_ = measure_parts(transport_);
  coverage_ = read_coverage(file(kPixelsFile), path(kPixelsFile), manifest_.pixels);
  reflectance_ = read_reflectance(file(kPixelsFile), path(kPixelsFile), manifest_.pixels);
  sketch_ = read_sketch(file(kSketchFile), path(kSketchFile), columns);
  for (const JsonReader& environment : reader.member("environments").elements(1, kMostFiles)) {
    read_environment(environment);
  }
}

Bake::~Bake() = default;

const TensorFile* Bake::find_file(const std::string& name) const {
  const auto found = files_.find(name);
  return found == files_.end() ? nullptr : &found->second;
}

const TensorFile& Bake::file(const std::string& name) const {
  if (const TensorFile* const found = find_file(name)) return *found;
  throw Error((folder_ / kManifestFile).string() + ": /files", "no " + quote(name), quote(name));
}

void Bake::read_environment(const JsonReader& json) {
  json.allow_only({"name", "layout", "exposure_scale", "file"});
  const std::string name = json.member("name").string();
  for (const BakedEnvironment& other : environments_) {
    if (other.environment->name() == name) json.member("name").fail("a name of its own");
  }
  const std::string file_name = json.member("file").string();
  const TensorFile& tensors = file(file_name);
  const std::string path = (folder_ / file_name).string();
  const auto& shape = tensors.shape("radiance");
  constexpr auto kMostSide = static_cast<std::size_t>(kLargestImageSide);
  if (shape.size() != 3 || shape[2] != 3 || shape[0] < 1 || shape[0] > kMostSide || shape[1] < 1 ||
      shape[1] > kMostSide || shape[0] * shape[1] > kMostImagePixels) {
    throw Error(path + ": tensor \"radiance\"", "shape " + shape_text(shape),
                "[height, width, 3] of an image");
  }
  RgbImage image(static_cast<int>(shape[1]), static_cast<int>(shape[0]));
  const auto values = tensors.tensor<float>("radiance", ElementType::f32);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const Vec3f pixel = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    if (!is_finite(pixel) || !(pixel.x >= 0 && pixel.y >= 0 && pixel.z >= 0)) {
      throw Error(path + ": pixel " + std::to_string(i),
                  "a radiance that is negative or not finite", "finite radiance");
    }
    image.pixels[i] = pixel;
  }
  environments_.push_back(
      {std::make_shared<Environment>(name, std::move(image), read_layout(json.member("layout"))),
       json.member("exposure_scale").number(1e-30, 1e30)});
}

void Bake::verify() const {
  static_cast<void>(read_manifest_text(folder_));
  for (const auto& item : files_) item.second.verify();
}

}  // namespace rimlight
