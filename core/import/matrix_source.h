#pragma once

#include <filesystem>

#include "core/import/npy_file.h"
#include "core/import/transport_source.h"

namespace rimlight {

/// A transport matrix in a .npy file: [receivers][directions], the same for all three channels, or
/// [receivers][directions][3]. Receivers are the pixels of a width × height picture, row by row
/// from the top. The file is mapped, never read as a whole.
class MatrixSource : public TransportSource {
 public:
  /// Throws Error naming the file and the field when its shape is another.
  MatrixSource(const std::filesystem::path& path, int width, int height);

  PixelLayout pixels() const override { return pixels_; }
  std::size_t direction_count() const override { return directions_; }
  void read_group(std::size_t first_receiver, std::span<float> rows) const override;

 private:
  NpyFile file_;
  PixelLayout pixels_;
  std::size_t directions_ = 0;
  std::size_t channels_ = 1;
};

}  // namespace rimlight
