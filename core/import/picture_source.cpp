#include "core/import/picture_source.h"

#include <fcntl.h>
#include <stdlib.h>  // NOLINT: mkstemp is POSIX, not in <cstdlib>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <string>

#include "core/bake/group.h"
#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/image/image_file.h"
#include "core/import/npy_file.h"

namespace rimlight {
namespace {

constexpr std::size_t kRowBytes = kRowLanes * sizeof(float);

std::string sides(const RgbImage& image) {
  return std::to_string(image.width) + " × " + std::to_string(image.height) + " pixels";
}

/// Float pictures can hold what no light gives: refused as in a matrix.
void check_range(const RgbImage& image, const std::filesystem::path& path) {
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    if (static_cast<double>(max_component(image.pixels[i])) <= kLargestTransport) continue;
    const auto width = static_cast<std::size_t>(image.width);
    throw Error(path.string() + ": pixel (" + std::to_string(i % width) + ", " +
                    std::to_string(i / width) + ")",
                "a value above 1e20", "radiance of at most 1e20");
  }
}

}  // namespace

/// A nameless file.
class PictureSource::ScratchFile {
 public:
  explicit ScratchFile(const std::filesystem::path& folder) {
    std::string name = (folder / ".pictures-XXXXXX").string();
    descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
    folder_ = folder.string();
    if (descriptor_ < 0) fail("a folder that can be written");
    ::unlink(name.c_str());
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile() { ::close(descriptor_); }

  void reserve(std::size_t bytes) const {
    // Told now, not after all pictures have been decoded. Some file systems cannot tell.
    const int error = ::posix_fallocate(descriptor_, 0, static_cast<off_t>(bytes));
    if (error != 0 && error != EOPNOTSUPP && error != EINVAL) {
      throw Error(folder_, std::strerror(error),
                  std::to_string((bytes >> 20) + 1) + " MiB for the pictures");
    }
  }

  void write(std::span<const std::byte> bytes, std::size_t offset) const {
    while (!bytes.empty()) {
      const ssize_t written =
          ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail("space to write to");
      bytes = bytes.subspan(static_cast<std::size_t>(written));
      offset += static_cast<std::size_t>(written);
    }
  }

  void read(std::span<std::byte> bytes, std::size_t offset) const {
    while (!bytes.empty()) {
      const ssize_t count =
          ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
      if (count < 0 && errno == EINTR) continue;
      if (count == 0) errno = EIO;
      if (count <= 0) fail("the pictures just written");
      bytes = bytes.subspan(static_cast<std::size_t>(count));
      offset += static_cast<std::size_t>(count);
    }
  }

 private:
  [[noreturn]] void fail(const char* expected) const {
    throw Error(folder_, std::strerror(errno), expected);
  }

  std::string folder_;
  int descriptor_ = -1;
};

RgbImage read_linear_picture(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (ending == ".exr") {
    RgbImage image = read_radiance(path);
    check_range(image, path);
    return image;
  }
  if (ending == ".png") return read_srgb_picture(path);
  throw Error(path.string(), "the ending " + quote(ending), "\".exr\" or \".png\"");
}

PictureSource::PictureSource(const std::vector<std::filesystem::path>& pictures,
                             const std::filesystem::path& scratch_folder,
                             const std::function<void(double)>& progress, std::size_t batch_bytes)
    : pictures_(pictures) {
  RIMLIGHT_CHECK(!pictures.empty());
  const RgbImage first = read_linear_picture(pictures.front());
  pixels_ = {first.width, first.height};
  scratch_ = std::make_unique<ScratchFile>(scratch_folder);
  scratch_->reserve(pixels_.receiver_count() / kGroupLanes * pictures.size() * kRowBytes);
  const std::size_t picture_bytes = pixels_.receiver_count() * sizeof(Vec3f);
  const std::size_t at_once =
      std::max<std::size_t>(batch_bytes / picture_bytes, static_cast<std::size_t>(thread_count()));
  for (std::size_t i = 0; i < pictures.size(); i += at_once) {
    add_batch(i, read_batch(i, std::min(at_once, pictures.size() - i)));
    if (progress) {
      progress(static_cast<double>(std::min(i + at_once, pictures.size())) /
               static_cast<double>(pictures.size()));
    }
  }
}

PictureSource::~PictureSource() = default;

std::vector<RgbImage> PictureSource::read_batch(std::size_t first, std::size_t count) const {
  std::vector<RgbImage> batch(count);
  parallel_for(count, [&](std::size_t i) {
    const auto& path = pictures_[first + i];
    batch[i] = read_linear_picture(path);
    if (batch[i].width != pixels_.width || batch[i].height != pixels_.height) {
      throw Error(path.string(), sides(batch[i]),
                  std::to_string(pixels_.width) + " × " + std::to_string(pixels_.height) +
                      " pixels, as " + quote(pictures_.front().filename().string()));
    }
  });
  return batch;
}

void PictureSource::add_batch(std::size_t first, std::span<const RgbImage> batch) {
  const std::size_t groups = pixels_.receiver_count() / kGroupLanes;
  parallel_for(groups, [&](std::size_t group) {
    std::vector<float> rows(batch.size() * kRowLanes);
    for (std::size_t lane = 0; lane < kGroupLanes; ++lane) {
      const auto [x, y] = pixels_.pixel(group * kGroupLanes + lane);
      if (x >= pixels_.width || y >= pixels_.height) continue;
      for (std::size_t i = 0; i < batch.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
          rows[i * kRowLanes + c * kGroupLanes + lane] = batch[i].at(x, y)[static_cast<int>(c)];
        }
      }
    }
    scratch_->write(std::as_bytes(std::span(rows)), (group * pictures_.size() + first) * kRowBytes);
  });
}

void PictureSource::read_group(std::size_t first_receiver, std::span<float> rows) const {
  RIMLIGHT_CHECK_EQ(rows.size(), pictures_.size() * kRowLanes);
  scratch_->read(std::as_writable_bytes(rows),
                 first_receiver / kGroupLanes * pictures_.size() * kRowBytes);
}

}  // namespace rimlight
