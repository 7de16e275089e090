#include <fcntl.h>
#include <stdio.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/parallel.h"
#include "core/transport/bake_folder.h"
#include "core/transport/bake_manifest.h"
#include "core/transport/bake_tensors.h"
#include "core/transport/curve_tensors.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLockFile = ".lock";

[[noreturn]] void fail(const fs::path& path, const char* expected) {
  throw Error(path.string(), std::strerror(errno), expected);
}

/// Runs `work`; what the file system throws becomes an Error.
template <typename Work>
void with_disk_errors(const Work& work) {
  try {
    work();
  } catch (const fs::filesystem_error& error) {
    throw Error(error.path1().string(), error.code().message(), "a disk that obeys");
  }
}

fs::path with_ending(const fs::path& path, const char* ending) {
  fs::path result = path;
  result += ending;
  return result;
}

/// Whatever stands at a bake's name is replaced: so it has to be a bake, or nothing.
void refuse_other_folders(const fs::path& folder) {
  if (!fs::exists(folder)) return;
  if (fs::is_directory(folder) && (fs::is_empty(folder) || fs::exists(folder / kManifestFile))) {
    return;
  }
  throw Error(folder.string(), "something else than a bake", "a bake to replace, or no such name");
}

template <typename Keep>
void remove_entries(const fs::path& folder, const Keep& keep) {
  std::vector<fs::path> doomed;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!keep(entry.path().filename().string())) doomed.push_back(entry.path());
  }
  for (const fs::path& path : doomed) fs::remove_all(path);
}

/// Puts `made` in the place of `name`; whatever had that name then has the name `made`.
void exchange_or_rename(const fs::path& made, const fs::path& name) {
  if (::renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, name.c_str(), RENAME_EXCHANGE) == 0) return;
  if (errno != ENOENT && errno != EINVAL && errno != ENOSYS) fail(name, "a name to replace");
  // There is none of that name; or the file system cannot exchange: then there is a moment with
  // the older bake at NAME.bake.replaced only.
  const fs::path replaced = with_ending(name, ".replaced");
  if (fs::exists(name)) {
    fs::remove_all(replaced);  // of a commit that was killed before it came to this
    fs::rename(name, replaced);
  }
  fs::rename(made, name);
  fs::remove_all(replaced);
}

/// Makes tiles on all cores, a few at a time, and uses them one by one in ascending order.
template <typename Make, typename Use>
void for_each_in_order(std::size_t count, const Make& make, const Use& use) {
  constexpr std::size_t kTilesAtOnce = 8;
  std::vector<TileTransport> tiles(kTilesAtOnce);
  for (std::size_t first = 0; first < count; first += kTilesAtOnce) {
    const std::size_t some = std::min(kTilesAtOnce, count - first);
    parallel_for(some, [&](std::size_t i) { tiles[i] = make(first + i); });
    std::for_each_n(tiles.begin(), some, use);
  }
}

}  // namespace

/// Held as long as its file is open: a killed writer leaves none.
class BakeWriter::Lock {
 public:
  explicit Lock(const fs::path& path)
      : descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    if (descriptor_ < 0) fail(path, "a folder to write to");
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
    ::close(descriptor_);
    throw Error(path.parent_path().string(), "another process writing it", "one writer at a time");
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  ~Lock() { ::close(descriptor_); }

 private:
  int descriptor_;
};

BakeWriter::BakeWriter(fs::path folder) : folder_(std::move(folder)) {
  if (!folder_.has_filename()) folder_ = folder_.parent_path();  // "name.bake/"
  partial_ = with_ending(folder_, ".partial");
  with_disk_errors([this] {
    refuse_other_folders(folder_);
    fs::create_directories(partial_);
    lock_ = std::make_unique<Lock>(partial_ / kLockFile);
    if (!fs::exists(partial_ / kManifestFile)) return;
    // Left by a killed commit. Perhaps somebody still maps it: unlinked, never overwritten.
    remove_entries(partial_, [](const std::string& name) { return name == kLockFile; });
  });
}

BakeWriter::~BakeWriter() = default;

std::unique_ptr<TensorFileWriter> BakeWriter::create(const std::string& file,
                                                     const std::vector<TensorShape>& tensors) {
  RIMLIGHT_CHECK(is_plain_file_name(file));
  return std::make_unique<TensorFileWriter>(partial_ / file, tensors);
}

void BakeWriter::add_file(const std::string& file, const TensorFileWriter::Summary& summary) {
  RIMLIGHT_CHECK(is_plain_file_name(file));
  RIMLIGHT_CHECK(files_.emplace(file, summary).second);
}

std::size_t BakeWriter::add_transport(std::size_t tile_count,
                                      const std::function<TileTransport(std::size_t)>& tile) {
  RIMLIGHT_CHECK(tile_count > 0);
  std::vector<std::uint64_t> first_word = {0};
  std::vector<std::uint32_t> run_offset;
  std::vector<float> step;
  for_each_in_order(tile_count, tile, [&](const TileTransport& next) {
    if (first_word.size() == 1) step = next.column_step;
    RIMLIGHT_CHECK(next.column_step == step);
    first_word.push_back(first_word.back() + next.runs.size());
    run_offset.insert(run_offset.end(), next.run_offset.begin(), next.run_offset.end());
  });
  const std::size_t columns = step.size(), words = first_word.back();
  RIMLIGHT_CHECK_EQ(run_offset.size(), tile_count * (columns + 1));
  const auto writer =
      create(kTransportFile, {{"column_step", ElementType::f32, {columns}},
                              {"tile_first_word", ElementType::u64, {tile_count + 1}},
                              {"run_offset", ElementType::u32, {tile_count, columns + 1}},
                              {"runs", ElementType::u64, {words}}});
  writer->append(std::span<const float>(step));
  writer->append(std::span<const std::uint64_t>(first_word));
  writer->append(std::span<const std::uint32_t>(run_offset));
  for_each_in_order(tile_count, tile, [&](const TileTransport& next) {
    writer->append(std::span<const std::uint64_t>(next.runs));
  });
  add_file(kTransportFile, writer->finish());
  return words * sizeof(std::uint64_t);
}

void BakeWriter::add_pixels(const PixelLayout& pixels, std::span<const float> coverage,
                            std::span<const Vec3f> reflectance) {
  const auto height = static_cast<std::size_t>(pixels.height);
  const auto width = static_cast<std::size_t>(pixels.width);
  RIMLIGHT_CHECK_EQ(coverage.size(), height * width);
  RIMLIGHT_CHECK_EQ(reflectance.size(), height * width);
  std::vector<std::uint8_t> bytes;
  for (const float share : coverage) {
    RIMLIGHT_CHECK(share >= 0 && share <= 1);
    bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * share)));
  }
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  const auto writer = create(kPixelsFile, {{"coverage", ElementType::u8, {height, width}},
                                           {"reflectance", ElementType::f32, {height, width, 3}}});
  writer->append(std::span<const std::uint8_t>(bytes));
  writer->append(reflectance);
  add_file(kPixelsFile, writer->finish());
}

void BakeWriter::add_sketch(const SketchSums& sums, const PixelLayout& pixels) {
  const auto open = [this](const char* name) {
    return TensorFile(partial_ / name, files_.at(name));
  };
  const auto path = [this](const char* name) { return (partial_ / name).string(); };
  const TensorFile transport_file = open(kTransportFile), pixels_file = open(kPixelsFile);
  const std::size_t columns = sums.sums().size() / (3 * kSketchRows);
  const TransportView stored =
      read_transport(transport_file, path(kTransportFile), pixels.tile_count(), columns);
  const auto writer = create(kSketchFile, sketch_tensors(columns));
  write_sketch(*writer,
               make_sketch(sums, stored, read_reflectance(pixels_file, path(kPixelsFile), pixels)));
  add_file(kSketchFile, writer->finish());
}

void BakeWriter::add_curves(const CurveReceivers& receivers) {
  const auto writer = create(kCurvesFile, curve_tensors(receivers));
  write_curves(*writer, receivers);
  add_file(kCurvesFile, writer->finish());
}

void BakeWriter::add_environment(const BakedEnvironment& baked) {
  const Environment& environment = *baked.environment;
  const RgbImage& image = environment.image();
  RIMLIGHT_CHECK(std::isfinite(baked.exposure_scale) && baked.exposure_scale > 0);
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  const std::string file = "environment_" + std::to_string(environments_.size()) + ".safetensors";
  const auto writer = create(
      file, {{"radiance",
              ElementType::f32,
              {static_cast<std::size_t>(image.height), static_cast<std::size_t>(image.width), 3}}});
  writer->append(std::span<const Vec3f>(image.pixels));
  add_file(file, writer->finish());
  environments_.push_back({{"name", environment.name()},
                           {"layout", layout_name(environment.layout())},
                           {"exposure_scale", baked.exposure_scale},
                           {"file", file}});
}

void BakeWriter::commit(const BakeManifest& manifest) {
  if (!manifest.materials.empty()) RIMLIGHT_CHECK(files_.contains(kCurvesFile));
  commit(manifest_to_json(manifest), {kTransportFile, kPixelsFile, kSketchFile});
}

void BakeWriter::commit(nlohmann::json json, std::initializer_list<const char*> needed) {
  for (const char* const file : needed) RIMLIGHT_CHECK(files_.contains(file));
  RIMLIGHT_CHECK(!environments_.empty());
  json["version"] = kBakeVersion;
  json["environments"] = environments_;
  json["files"] = nlohmann::json::object();
  for (const auto& [name, summary] : files_) json["files"][name] = summary.to_json();
  // Names that came from file names may be no valid UTF-8: replaced, not refused.
  const std::string text =
      json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  with_disk_errors([&] {
    remove_entries(partial_, [&](const std::string& name) {
      return name == kLockFile || files_.contains(name);
    });
    write_file_atomically(partial_ / kManifestHashFile, manifest_hash_line(text));
    write_file_atomically(partial_ / kManifestFile, text);
    fs::remove(partial_ / kLockFile);
    flush_to_disk(partial_);
    exchange_or_rename(partial_, folder_);
    const fs::path parent = folder_.parent_path();
    flush_to_disk(parent.empty() ? fs::path(".") : parent);
    fs::remove_all(partial_);  // the bake that was replaced
  });
}

}  // namespace rimlight
