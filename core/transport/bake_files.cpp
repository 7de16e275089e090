#include "core/transport/bake_files.h"

#include <limits>

#include "core/base/error.h"
#include "core/image/image_file.h"
#include "core/transport/bake_manifest.h"
#include "core/transport/bake_tensors.h"

namespace rimlight {
namespace {

constexpr std::size_t kMostFiles = 4096;
constexpr std::size_t kMostImagePixels = std::size_t{1} << 28;

void expect_folder(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (std::filesystem::is_directory(folder, ignored)) return;
  throw Error(folder.string(), "no folder", "a bake");
}

void expect_version(const JsonReader& manifest) {
  const JsonReader version = manifest.member("version");
  if (version.integer(0, std::numeric_limits<std::int32_t>::max()) != kBakeVersion) {
    version.fail(std::to_string(kBakeVersion));
  }
}

RgbImage read_image(const TensorFile& tensors, const std::string& path) {
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
  return image;
}

}  // namespace

std::string bake_kind(const std::filesystem::path& folder) {
  expect_folder(folder);
  const std::string source = (folder / kManifestFile).string();
  const nlohmann::json json = parse_json(read_manifest_text(folder), source);
  const JsonReader reader(json, source);
  expect_version(reader);
  const std::vector<std::string> kinds = {kImageKind, kCurveKind, kVertexKind};
  return kinds[reader.member("kind").one_of(kinds)];
}

BakeFiles::BakeFiles(const std::filesystem::path& folder) : folder_(folder) {
  expect_folder(folder);
  const std::string text = read_manifest_text(folder);
  manifest_ = parse_json(text, path(kManifestFile));
  // First, so that a later version is told as such and not by its unknown fields.
  expect_version(manifest());
  const JsonReader listed = manifest().member("files");
  for (const auto& [name, summary] : listed.members()) {
    if (!is_plain_file_name(name)) summary.fail("a plain file name");
    if (files_.size() == kMostFiles) {
      listed.fail("at most " + std::to_string(kMostFiles) + " files");
    }
    files_.emplace(name, TensorFile(folder / name, TensorFileSummary::from_json(summary)));
  }
  sizes_ = {{kManifestFile, text.size()}, {kManifestHashFile, manifest_hash_line(text).size()}};
  for (const auto& item : files_) sizes_.emplace_back(item.first, item.second.byte_count());
}

const TensorFile* BakeFiles::find_file(const std::string& name) const {
  const auto found = files_.find(name);
  return found == files_.end() ? nullptr : &found->second;
}

const TensorFile& BakeFiles::file(const std::string& name) const {
  if (const TensorFile* const found = find_file(name)) return *found;
  throw Error(path(kManifestFile) + ": /files", "no " + quote(name), quote(name));
}

std::vector<BakedEnvironment> BakeFiles::read_environments() const {
  std::vector<BakedEnvironment> environments;
  // By value: the elements refer to the manifest, which lives as long as this.
  for (const JsonReader& json : manifest().member("environments").elements(1, kMostFiles)) {
    const std::string name = json.member("name").string();
    for (const BakedEnvironment& other : environments) {
      if (other.environment->name() == name) json.member("name").fail("a name of its own");
    }
    environments.push_back(read_environment(json));
  }
  return environments;
}

BakedEnvironment BakeFiles::read_environment(const JsonReader& json) const {
  json.allow_only({"name", "layout", "exposure_scale", "file"});
  const std::string file_name = json.member("file").string();
  RgbImage image = read_image(file(file_name), path(file_name));
  return {std::make_shared<Environment>(json.member("name").string(), std::move(image),
                                        read_layout(json.member("layout"))),
          json.member("exposure_scale").number(1e-30, 1e30)};
}

void BakeFiles::verify() const {
  static_cast<void>(read_manifest_text(folder_));
  for (const auto& item : files_) item.second.verify();
}

}  // namespace rimlight
