#include "core/import/coverage_mask.h"

#include <algorithm>

#include "core/base/files.h"
#include "core/image/codec.h"
#include "core/import/picture_source.h"

namespace rimlight {
namespace {

constexpr std::size_t kMostFileBytes = std::size_t{1} << 30;

bool is_png(std::span<const std::byte> bytes) {
  return bytes.size() > 1 && bytes[0] == std::byte{0x89} && bytes[1] == std::byte{'P'};
}

}  // namespace

CoverageMask read_mask(const std::filesystem::path& path) {
  CoverageMask mask{path.string(), 0, 0, {}};
  const MappedFile file(path, kMostFileBytes);
  const std::span<const std::byte> bytes = file.bytes();
  if (is_png(bytes)) {
    const Rgb8Image image = decode_png(reinterpret_cast<const std::uint8_t*>(bytes.data()),
                                       bytes.size(), path.string());
    mask.width = image.width;
    mask.height = image.height;
    for (std::size_t i = 0; i < image.bytes.size(); i += 3) {
      mask.shares.push_back(static_cast<float>(image.bytes[i]) / 255);
    }
    return mask;
  }
  const RgbImage image = read_linear_picture(path);
  mask.width = image.width;
  mask.height = image.height;
  for (const Vec3f& pixel : image.pixels) mask.shares.push_back(std::min(pixel.x, 1.0f));
  return mask;
}

}  // namespace rimlight
