#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/image/image.h"
#include "core/import/transport_source.h"

namespace rimlight {

/// Decoded pictures take at most this much memory at a time (or one picture a thread, if that is
/// more).
inline constexpr std::size_t kPictureBatchBytes = std::size_t{512} << 20;

/// A linear picture by its ending, in any letter case: .exr as it is, .png with the sRGB curve
/// undone. Throws Error.
RgbImage read_linear_picture(const std::filesystem::path& path);

/// One picture for each light, all of one size. Each is decoded once, some at a time
/// (kPictureBatchBytes), and laid out anew by groups of pixels in a temporary file of 12 bytes a
/// pixel and picture, so that memory stays bounded whatever their number. The file has no name: it
/// is gone with this object, or when the program is killed.
class PictureSource : public TransportSource {
 public:
  /// `scratch_folder` must exist and have room; `progress` (may be empty) is told the share that is
  /// read; `batch_bytes` bounds the pictures that are decoded at a time. Throws Error naming the
  /// picture: unreadable, another format, another size than the first; or when the disk is full.
  PictureSource(const std::vector<std::filesystem::path>& pictures,
                const std::filesystem::path& scratch_folder,
                const std::function<void(double)>& progress,
                std::size_t batch_bytes = kPictureBatchBytes);
  ~PictureSource() override;

  PixelLayout pixels() const override { return pixels_; }
  std::size_t direction_count() const override { return pictures_.size(); }
  void read_group(std::size_t first_receiver, std::span<float> rows) const override;

 private:
  class ScratchFile;

  void add_batch(std::size_t first, std::span<const RgbImage> batch);
  std::vector<RgbImage> read_batch(std::size_t first, std::size_t count) const;

  std::vector<std::filesystem::path> pictures_;
  PixelLayout pixels_;
  std::unique_ptr<ScratchFile> scratch_;  // [group][picture][channel][64] floats
};

}  // namespace rimlight
