#include "core/image/image_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/image/codec.h"
#include "core/image/tone_map.h"

namespace rimlight {
namespace {

/// Room for kMostPixels of three floats, and for the header.
constexpr std::size_t kLargestFile = std::size_t{4} << 30;

std::string lower_case_ending(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return ending;
}

void check_radiance(RgbImage& image, const std::string& name) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      Vec3f& pixel = image.at(x, y);
      for (int c = 0; c < 3; ++c) {
        if (!std::isfinite(pixel[c])) {
          throw Error(name + ": pixel (" + std::to_string(x) + ", " + std::to_string(y) + ")",
                      std::to_string(pixel[c]), "finite radiance");
        }
        pixel[c] = std::max(pixel[c], 0.0f);
      }
    }
  }
}

RgbImage linear_from_srgb_bytes(const Rgb8Image& picture) {
  std::array<float, 256> linear;
  for (std::size_t i = 0; i < linear.size(); ++i) {
    linear[i] = static_cast<float>(linear_from_srgb(static_cast<double>(i) / 255));
  }
  RgbImage image(picture.width, picture.height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const std::uint8_t* const p = picture.bytes.data() + 3 * i;
    image.pixels[i] = {linear[p[0]], linear[p[1]], linear[p[2]]};
  }
  return image;
}

}  // namespace

RgbImage read_radiance(const std::filesystem::path& path) {
  const std::string ending = lower_case_ending(path);
  if (ending != ".hdr" && ending != ".exr") {
    throw Error(path.string(), "the ending " + quote(ending), "\".hdr\" or \".exr\"");
  }
  const MappedFile file(path, kLargestFile);
  RgbImage image = ending == ".hdr" ? decode_hdr(file.bytes(), path.string())
                                    : decode_exr(file.bytes(), path.string());
  check_radiance(image, path.string());
  return image;
}

RgbImage read_srgb_picture(const std::filesystem::path& path) {
  const MappedFile file(path, kLargestFile);
  return decode_srgb_picture(file.bytes().data(), file.bytes().size(), path.string());
}

RgbImage decode_srgb_picture(const void* bytes, std::size_t size, const std::string& name) {
  constexpr std::string_view kPng = "\x89PNG\r\n\x1a\n";
  constexpr std::string_view kJpeg = "\xff\xd8\xff";
  const std::string_view text(static_cast<const char*>(bytes), size);
  const auto* const data = static_cast<const std::uint8_t*>(bytes);
  if (text.starts_with(kPng)) return linear_from_srgb_bytes(decode_png(data, size, name));
  if (text.starts_with(kJpeg)) return linear_from_srgb_bytes(decode_jpeg(data, size, name));
  throw Error(name, "neither PNG nor JPEG", "a PNG or JPEG picture");
}

}  // namespace rimlight
