#include <png.h>

#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <new>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/image/codec.h"
#include "core/image/image_size.h"

namespace rimlight {
namespace {

/// libpng reports errors by longjmp, which must not pass a C++ object that has a destructor: what
/// has one lives in encode_png, and the frames between its setjmp and libpng hold plain values.
struct PngWriter {
  std::vector<std::uint8_t>& bytes;
  char message[120] = "";
  png_structp png = nullptr;
  png_infop info = nullptr;

  explicit PngWriter(std::vector<std::uint8_t>& to) : bytes(to) {
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, this, &on_error, &on_warning);
    if (png != nullptr) info = png_create_info_struct(png);
  }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }

  [[noreturn]] static void on_error(png_structp png, png_const_charp text) {
    auto* const self = static_cast<PngWriter*>(png_get_error_ptr(png));
    std::snprintf(self->message, sizeof self->message, "%s", text);
    png_longjmp(png, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}

  static void on_bytes(png_structp png, png_bytep bytes, std::size_t count) {
    if (!static_cast<PngWriter*>(png_get_io_ptr(png))->append(bytes, count)) {
      png_error(png, "out of memory");
    }
  }
  bool append(const std::uint8_t* from, std::size_t count) noexcept {
    try {
      bytes.insert(bytes.end(), from, from + count);
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  }
};

/// False when libpng reported an error.
bool write_image(PngWriter& writer, const Rgb8Image& image) {
  if (setjmp(png_jmpbuf(writer.png)) != 0) return false;
  png_set_write_fn(writer.png, &writer, &PngWriter::on_bytes, nullptr);
  png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(image.width),
               static_cast<png_uint_32>(image.height), 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_set_compression_level(writer.png, 1);
  png_set_compression_buffer_size(writer.png, std::size_t{1} << 16);
  png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
  png_write_info(writer.png, writer.info);
  const auto row_bytes = 3 * static_cast<std::size_t>(image.width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    png_write_row(writer.png, image.bytes.data() + y * row_bytes);
  }
  png_write_end(writer.png, nullptr);
  return true;
}

/// True when every chunk up to IEND lies inside the bytes. (The decoder stops after the last row
/// and would not miss the end.)
bool reaches_its_end(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::size_t kSignature = 8;
  constexpr std::size_t kChunkFrame = 12;  // length, type, CRC
  for (std::size_t at = kSignature; at <= size && size - at >= kChunkFrame;) {
    const std::size_t length = png_get_uint_32(bytes + at);
    if (length > size - at - kChunkFrame) return false;
    if (std::memcmp(bytes + at + 4, "IEND", 4) == 0) return true;
    at += kChunkFrame + length;
  }
  return false;
}

/// libpng's image reader, which keeps its setjmp to itself.
struct PngReader {
  png_image image;

  PngReader() : image() { image.version = PNG_IMAGE_VERSION; }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_image_free(&image); }
};

void drop_alpha(const AlignedVector<std::uint8_t>& rgba, AlignedVector<std::uint8_t>& rgb) {
  for (std::size_t i = 0; i < rgb.size() / 3; ++i) {
    std::memcpy(rgb.data() + 3 * i, rgba.data() + 4 * i, 3);
  }
}

}  // namespace

void encode_png(const Rgb8Image& image, std::vector<std::uint8_t>& png) {
  RIMLIGHT_CHECK(image.width > 0 && image.height > 0);
  RIMLIGHT_CHECK_EQ(image.bytes.size(), static_cast<std::size_t>(image.width) *
                                            static_cast<std::size_t>(image.height) * 3);
  png.clear();
  PngWriter writer(png);
  if (writer.info == nullptr) throw std::bad_alloc();
  if (!write_image(writer, image)) {
    throw Error("PNG", quote(writer.message), "an image that can be compressed");
  }
}

Rgb8Image decode_png(const std::uint8_t* bytes, std::size_t size, std::string_view source) {
  PngReader reader;
  const auto fail = [&] {
    throw Error(std::string(source), quote(reader.image.message), "a whole PNG picture");
  };
  if (png_image_begin_read_from_memory(&reader.image, bytes, size) == 0) fail();
  check_image_size(reader.image.width, reader.image.height, std::string(source));
  if (!reaches_its_end(bytes, size)) {
    throw Error(std::string(source), "a truncated file", "a whole PNG picture");
  }
  const bool has_alpha = (reader.image.format & PNG_FORMAT_FLAG_ALPHA) != 0;
  reader.image.format = has_alpha ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  reader.image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;

  Rgb8Image result(static_cast<int>(reader.image.width), static_cast<int>(reader.image.height));
  AlignedVector<std::uint8_t> rgba;
  if (has_alpha) rgba.resize(result.bytes.size() / 3 * 4);
  std::uint8_t* const to = has_alpha ? rgba.data() : result.bytes.data();
  if (png_image_finish_read(&reader.image, nullptr, to, /*row_stride=*/0, nullptr) == 0) fail();
  if (has_alpha) drop_alpha(rgba, result.bytes);
  return result;
}

}  // namespace rimlight
