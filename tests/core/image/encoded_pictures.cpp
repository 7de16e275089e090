#include "tests/core/image/encoded_pictures.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <ImfTiledOutputFile.h>

#include <cmath>
#include <deque>

#include "core/math/random.h"

namespace rimlight::test {
namespace {

std::uint8_t component(const Rgbe& pixel, int c) {
  return c == 0 ? pixel.r : c == 1 ? pixel.g : c == 2 ? pixel.b : pixel.e;
}

/// One component of one row: runs where at least three values are equal, else literals.
void append_row_component(const Rgbe* row, int width, int c, std::string& out) {
  const auto value = [&](int x) { return component(row[x], c); };
  const auto run_at = [&](int x) {
    int end = x + 1;
    while (end < width && end - x < 127 && value(end) == value(x)) ++end;
    return end - x;
  };
  for (int x = 0; x < width;) {
    if (const int run = run_at(x); run >= 3) {
      out += static_cast<char>(128 + run);
      out += static_cast<char>(value(x));
      x += run;
      continue;
    }
    int end = x + 1;
    while (end < width && end - x < 128 && run_at(end) < 3) ++end;
    out += static_cast<char>(end - x);
    for (; x < end; ++x) out += static_cast<char>(value(x));
  }
}

std::string size_line(const RgbePicture& picture) {
  return "-Y " + std::to_string(picture.height) + " +X " + std::to_string(picture.width);
}

std::size_t bytes_of_type(Imf::PixelType type) { return type == Imf::HALF ? 2 : 4; }

/// The values in their stored type.
std::string stored(const ExrChannel& channel) {
  std::string bytes;
  const auto append = [&](auto value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const float value : channel.values) {
    if (channel.type == Imf::HALF) append(Imath::half(value));
    if (channel.type == Imf::FLOAT) append(value);
    if (channel.type == Imf::UINT) append(static_cast<std::uint32_t>(value));
  }
  return bytes;
}

}  // namespace

RgbePicture random_rgbe(int width, int height, std::uint64_t seed) {
  Random random(seed);
  RgbePicture picture{width, height, {}};
  Rgbe pixel;
  for (int i = 0; i < width * height; ++i) {
    if (i == 0 || random.below(3) != 0) {
      pixel.r = static_cast<std::uint8_t>(128 + random.below(128));
      pixel.g = static_cast<std::uint8_t>(random.below(256));
      pixel.b = static_cast<std::uint8_t>(random.below(256));
      pixel.e = static_cast<std::uint8_t>(100 + random.below(61));
    }
    picture.pixels.push_back(pixel);
  }
  return picture;
}

std::string hdr_header(std::string_view size_line) {
  return "#?RADIANCE\n# a comment\nEXPOSURE=1\nFORMAT=32-bit_rle_rgbe\n\n" +
         std::string(size_line) + "\n";
}

std::string hdr_with_runs(const RgbePicture& picture) {
  std::string out = hdr_header(size_line(picture));
  for (int y = 0; y < picture.height; ++y) {
    out += {2, 2, static_cast<char>(picture.width >> 8), static_cast<char>(picture.width & 255)};
    const Rgbe* const row = picture.pixels.data() + y * picture.width;
    for (int c = 0; c < 4; ++c) append_row_component(row, picture.width, c, out);
  }
  return out;
}

std::string hdr_flat(const RgbePicture& picture) {
  std::string out = hdr_header(size_line(picture));
  for (const Rgbe& pixel : picture.pixels) {
    for (int c = 0; c < 4; ++c) out += static_cast<char>(component(pixel, c));
  }
  return out;
}

std::string exr_file(Imf::Header header, const std::vector<ExrChannel>& channels) {
  const Imath::Box2i window = header.dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
  Imf::FrameBuffer buffer;
  std::deque<std::string> storage;  // keeps addresses
  for (const ExrChannel& channel : channels) {
    header.channels().insert(channel.name, Imf::Channel(channel.type));
    const std::size_t size = bytes_of_type(channel.type);
    buffer.insert(channel.name,
                  Imf::Slice::Make(channel.type, storage.emplace_back(stored(channel)).data(),
                                   window, size, size * width));
  }
  Imf::StdOSStream stream;
  if (header.hasTileDescription()) {
    Imf::TiledOutputFile file(stream, header, 0);
    file.setFrameBuffer(buffer);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  } else {
    Imf::OutputFile file(stream, header, 0);
    file.setFrameBuffer(buffer);
    file.writePixels(window.max.y - window.min.y + 1);
  }
  return stream.str();
}

std::vector<ExrChannel> rgb_channels(const RgbImage& image, Imf::PixelType type) {
  std::vector<ExrChannel> channels = {{"R", type, {}}, {"G", type, {}}, {"B", type, {}}};
  for (const Vec3f& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) channels[static_cast<std::size_t>(c)].values.push_back(pixel[c]);
  }
  return channels;
}

RgbImage random_image(int width, int height, std::uint64_t seed) {
  Random random(seed);
  RgbImage image(width, height);
  for (Vec3f& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) pixel[c] = random.uniform_float();
  }
  return image;
}

Rgb8Image random_bytes_image(int width, int height, std::uint64_t seed) {
  Random random(seed);
  Rgb8Image image(width, height);
  for (std::uint8_t& byte : image.bytes) byte = static_cast<std::uint8_t>(random.below(256));
  return image;
}

Rgb8Image smooth_image(int width, int height) {
  Rgb8Image image(width, height);
  std::size_t i = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double edge = (x / 24 + y / 40) % 2 == 0 ? 40 : 0;
      for (int c = 0; c < 3; ++c) {
        const double wave = std::sin(0.05 * x + 0.3 * c) * std::cos(0.04 * y - 0.2 * c);
        image.bytes[i++] = static_cast<std::uint8_t>(110 + 80 * wave + edge);
      }
    }
  }
  return image;
}

}  // namespace rimlight::test
