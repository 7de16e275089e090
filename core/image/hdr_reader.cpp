#include <stb/stb_image.h>

#include <charconv>
#include <climits>
#include <cstring>
#include <memory>
#include <string_view>

#include "core/base/error.h"
#include "core/image/image_file.h"

namespace rimlight {
namespace {

struct HdrHeader {
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::string_view pixels;  // the bytes behind the header
};

/// The next line without its end; `text` goes on behind it.
std::string_view take_line(std::string_view& text, const std::string& name) {
  const std::size_t end = text.find('\n');
  if (end == std::string_view::npos) throw Error(name, "a truncated header", "a whole header");
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end + 1);
  // stb_image compares lines as C strings: a zero byte would let it read another header than ours.
  if (line.find('\0') != std::string_view::npos) {
    throw Error(name, "a zero byte in the header", "a header of text lines");
  }
  return line;
}

/// "-Y height +X width": the one orientation that stb_image reads.
void parse_size(std::string_view line, HdrHeader& header, const std::string& name) {
  std::string_view rest = line;
  const auto take = [&](std::string_view axis, std::int64_t& side) {
    if (!rest.starts_with(axis)) return false;
    rest.remove_prefix(axis.size());
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), side);
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    return error == std::errc();
  };
  if (!take("-Y ", header.height) || !take(" +X ", header.width) || !rest.empty()) {
    throw Error(name, "the size " + quote(line), "\"-Y HEIGHT +X WIDTH\"");
  }
}

HdrHeader parse_header(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("#?RADIANCE\n") && !bytes.starts_with("#?RGBE\n")) {
    throw Error(name, "another format", "a Radiance picture (\"#?RADIANCE\")");
  }
  bool is_rgbe = false;
  for (std::string_view line = take_line(bytes, name); !line.empty();
       line = take_line(bytes, name)) {
    is_rgbe = is_rgbe || line == "FORMAT=32-bit_rle_rgbe";
  }
  if (!is_rgbe) throw Error(name, "no such FORMAT line", "\"FORMAT=32-bit_rle_rgbe\"");
  HdrHeader header;
  parse_size(take_line(bytes, name), header, name);
  check_image_size(header.width, header.height, name);
  header.pixels = bytes;
  return header;
}

[[noreturn]] void fail_truncated(std::int64_t row, const std::string& name) {
  throw Error(name + ": row " + std::to_string(row), "the end of the file", "more pixels");
}

unsigned byte_at(std::string_view bytes, std::size_t i) {
  return static_cast<unsigned char>(bytes[i]);
}

/// Walks over one row of run lengths and returns what is behind it.
std::string_view skip_row(std::string_view bytes, std::int64_t width, std::int64_t row,
                          const std::string& name) {
  if (bytes.size() < 4) fail_truncated(row, name);
  const std::int64_t length = byte_at(bytes, 2) << 8 | byte_at(bytes, 3);
  if (byte_at(bytes, 0) != 2 || byte_at(bytes, 1) != 2 || length != width) {
    throw Error(name + ": row " + std::to_string(row), "no row of run lengths",
                "a row of " + std::to_string(width) + " pixels");
  }
  bytes.remove_prefix(4);
  for (int component = 0; component < 4; ++component) {
    for (std::int64_t x = 0; x < width;) {
      if (bytes.empty()) fail_truncated(row, name);
      const unsigned code = byte_at(bytes, 0);
      const std::int64_t count = code > 128 ? code - 128 : code;
      if (count == 0 || count > width - x) {
        throw Error(name + ": row " + std::to_string(row),
                    "a run of " + std::to_string(count) + " pixels",
                    "1 to " + std::to_string(width - x) + " pixels");
      }
      const std::size_t size = code > 128 ? 2 : 1 + static_cast<std::size_t>(count);
      if (bytes.size() < size) fail_truncated(row, name);
      bytes.remove_prefix(size);
      x += count;
    }
  }
  return bytes;
}

/// Takes the path that stb_image will take, so that it can neither run out of bytes (it would go on
/// with zeros) nor meet an empty run (it would wait for ever).
void check_pixels(const HdrHeader& header, const std::string& name) {
  std::string_view bytes = header.pixels;
  if (bytes.size() < 4) fail_truncated(0, name);
  const bool has_runs = header.width >= 8 && byte_at(bytes, 0) == 2 && byte_at(bytes, 1) == 2 &&
                        byte_at(bytes, 2) < 128;
  if (has_runs) {
    for (std::int64_t y = 0; y < header.height; ++y) bytes = skip_row(bytes, header.width, y, name);
    return;
  }
  const auto row_bytes = static_cast<std::size_t>(4 * header.width);
  const auto rows = static_cast<std::int64_t>(bytes.size() / row_bytes);
  if (rows < header.height) fail_truncated(rows, name);
}

}  // namespace

RgbImage decode_hdr(std::span<const std::byte> bytes, const std::string& name) {
  if (bytes.size() > INT_MAX) {  // stb_image counts bytes in an int
    throw Error(name, std::to_string(bytes.size()) + " bytes",
                "at most " + std::to_string(INT_MAX) + " bytes");
  }
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const HdrHeader header = parse_header(text, name);
  check_pixels(header, name);

  int width = 0;
  int height = 0;
  const std::unique_ptr<float, decltype(&stbi_image_free)> decoded(
      stbi_loadf_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                             static_cast<int>(bytes.size()), &width, &height, nullptr, 3),
      &stbi_image_free);
  if (!decoded || width != header.width || height != header.height) {
    throw Error(name, "pixels that cannot be decoded", "a whole Radiance picture");
  }
  RgbImage image(width, height);
  const float* value = decoded.get();
  for (Vec3f& pixel : image.pixels) {
    pixel = {value[0], value[1], value[2]};
    value += 3;
  }
  return image;
}

}  // namespace rimlight
