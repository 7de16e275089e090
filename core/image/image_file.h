#pragma once

#include <filesystem>
#include <string>

#include "core/image/image.h"

namespace rimlight {

/// The largest image side that any reader accepts; checked before anything is allocated.
inline constexpr int kLargestImageSide = 16384;

/// Reads a high-dynamic-range image by its ending: .hdr (Radiance RGBE, stb_image) or .exr
/// (OpenEXR, R, G, B of any pixel type; the data window is read, lineOrder is honoured). Throws
/// Error naming the file: missing, other format, claims more than kLargestImageSide or 2^28 pixels,
/// truncated, or a radiance that is not finite (with its pixel). Negative radiance is set to 0.
RgbImage read_radiance(const std::filesystem::path& path);

/// Reads an 8-bit picture (.png, .jpg, by stb_image) as linear RGB (the sRGB curve undone), for
/// textures. Same errors as read_radiance.
RgbImage read_srgb_picture(const std::filesystem::path& path);

/// The same for a picture in memory (a texture embedded in a mesh file); `name` stands in errors.
RgbImage decode_srgb_picture(const void* bytes, std::size_t size, const std::string& name);

/// Writes R, G, B as 32-bit floats, ZIP compressed; atomically. Throws Error.
void write_exr(const std::filesystem::path& path, const RgbImage& image);

}  // namespace rimlight
