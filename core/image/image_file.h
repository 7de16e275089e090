#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "core/image/image.h"
#include "core/image/image_size.h"

namespace rimlight {

/// Reads a high-dynamic-range image by its ending: .hdr (decode_hdr) or .exr (decode_exr), in any
/// letter case. Throws Error naming the file: missing, other format, claims more than
/// check_image_size allows, truncated, or a radiance that is not finite (with its pixel). Negative
/// radiance is set to 0.
RgbImage read_radiance(const std::filesystem::path& path);

/// A Radiance RGBE picture in memory, by stb_image; `name` stands in errors. Layout "-Y +X" (top
/// row first), flat or with the run lengths of 1991; EXPOSURE lines are ignored. The whole run
/// structure is checked before anything is allocated: stb_image takes missing bytes for zeros, or
/// waits for ever.
RgbImage decode_hdr(std::span<const std::byte> bytes, const std::string& name);

/// An OpenEXR picture in memory; `name` stands in errors. Channels R, G, B, or Y alone for all
/// three; any pixel type; scan lines or tiles (their finest level); the data window is read,
/// lineOrder is honoured. One part, not deep; the names of other channels stand in the error.
RgbImage decode_exr(std::span<const std::byte> bytes, const std::string& name);

/// Reads an 8-bit picture (.png by libpng, .jpg by libjpeg-turbo, told apart by their first bytes)
/// as linear RGB (the sRGB curve undone, alpha ignored), for textures. Same errors as
/// read_radiance.
RgbImage read_srgb_picture(const std::filesystem::path& path);

/// The same for a picture in memory (a texture embedded in a mesh file); `name` stands in errors.
RgbImage decode_srgb_picture(const void* bytes, std::size_t size, const std::string& name);

/// Writes R, G, B as 32-bit floats, ZIP compressed; atomically. Throws Error.
void write_exr(const std::filesystem::path& path, const RgbImage& image);

}  // namespace rimlight
