#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStdIO.h>

#include <algorithm>
#include <cstring>
#include <string_view>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/files.h"
#include "core/image/image_file.h"

namespace rimlight {
namespace {

/// Feeds bytes in memory to OpenEXR.
class ByteStream final : public Imf::IStream {
 public:
  ByteStream(std::span<const std::byte> bytes, const std::string& name)
      : Imf::IStream(name.c_str()), bytes_(bytes) {}

  bool read(char* to, int count) override {
    const auto wanted = static_cast<std::size_t>(std::max(count, 0));
    if (position_ > bytes_.size() || wanted > bytes_.size() - position_) {
      throw Iex::InputExc("the end of the file");
    }
    std::memcpy(to, bytes_.data() + position_, wanted);
    position_ += wanted;
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

 private:
  std::span<const std::byte> bytes_;
  std::uint64_t position_ = 0;
};

/// Reads the header's few plain fields, little-endian.
class HeaderCursor {
 public:
  HeaderCursor(std::span<const std::byte> bytes, const std::string& name)
      : bytes_(bytes), name_(name) {}

  std::span<const std::byte> take(std::size_t count) {
    if (count > bytes_.size()) throw Error(name_, "a truncated header", "a whole header");
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  std::int32_t integer() {
    std::int32_t value = 0;
    std::memcpy(&value, take(4).data(), sizeof value);
    return value;
  }
  /// Up to the zero byte, which is skipped.
  std::string_view word() {
    const std::string_view rest(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
    const std::string_view word = rest.substr(0, rest.find('\0'));
    take(word.size() + 1);
    return word;
  }
  const std::string& name() const { return name_; }

 private:
  std::span<const std::byte> bytes_;
  const std::string& name_;
};

constexpr std::int32_t kMagic = 20000630;
constexpr std::int32_t kDeepFlag = 0x800;
constexpr std::int32_t kMultiPartFlag = 0x1000;

/// What decides how much OpenEXR allocates when it opens the file.
struct ExrClaims {
  std::int64_t width = 0;
  std::int64_t height = 0;
  std::int64_t tile_width = 0;  // 0: scan lines
  std::int64_t tile_height = 0;
};

void read_window(HeaderCursor value, ExrClaims& claims) {
  const std::int64_t left = value.integer();
  const std::int64_t top = value.integer();
  const std::int64_t right = value.integer();
  const std::int64_t bottom = value.integer();
  claims.width = right - left + 1;
  claims.height = bottom - top + 1;
}

void read_tiles(HeaderCursor value, ExrClaims& claims) {
  constexpr std::int64_t kLargestTile = 4096;
  claims.tile_width = static_cast<std::uint32_t>(value.integer());
  claims.tile_height = static_cast<std::uint32_t>(value.integer());
  for (const std::int64_t side : {claims.tile_width, claims.tile_height}) {
    if (side >= 1 && side <= kLargestTile) continue;
    throw Error(value.name(), "tiles with a side of " + std::to_string(side),
                "1 to " + std::to_string(kLargestTile));
  }
}

/// One attribute: its size must stay inside the file, for OpenEXR allocates it unchecked.
void read_attribute(std::string_view attribute, HeaderCursor& cursor, ExrClaims& claims) {
  constexpr std::size_t kLargestChannelList = 8192;  // OpenEXR's buffers grow with the channels
  cursor.word();                                     // the type
  const auto size = static_cast<std::size_t>(static_cast<std::uint32_t>(cursor.integer()));
  const HeaderCursor value(cursor.take(size), cursor.name());
  if (attribute == "dataWindow") read_window(value, claims);
  if (attribute == "tiles") read_tiles(value, claims);
  if (attribute == "channels" && size > kLargestChannelList) {
    throw Error(cursor.name(), "a channel list of " + std::to_string(size) + " bytes",
                "at most " + std::to_string(kLargestChannelList));
  }
}

/// Walks the header as OpenEXR will, before OpenEXR allocates anything by it.
void check_claims(std::span<const std::byte> bytes, const std::string& name) {
  HeaderCursor cursor(bytes, name);
  if (bytes.size() < 8 || cursor.integer() != kMagic) {
    throw Error(name, "another format", "an OpenEXR picture");
  }
  if ((cursor.integer() & (kDeepFlag | kMultiPartFlag)) != 0) {
    throw Error(name, "a file of several parts, or a deep one", "one flat part");
  }
  ExrClaims claims;
  for (std::string_view attribute = cursor.word(); !attribute.empty(); attribute = cursor.word()) {
    read_attribute(attribute, cursor, claims);
  }
  check_image_size(claims.width, claims.height, name);
  if (claims.tile_width == 0) return;
  const std::int64_t tiles = ((claims.width + claims.tile_width - 1) / claims.tile_width) *
                             ((claims.height + claims.tile_height - 1) / claims.tile_height);
  constexpr std::int64_t kLeastBytesOfTile = 8 + 20;  // place in the table, head of the chunk
  if (tiles * kLeastBytesOfTile > static_cast<std::int64_t>(bytes.size())) {
    throw Error(name, "the end of the file", std::to_string(tiles) + " tiles");
  }
}

[[noreturn]] void fail_channels(const Imf::ChannelList& channels, const std::string& name) {
  std::string found = "the channels";
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    found += " " + quote(channel.name());
  }
  if (channels.begin() == channels.end()) found = "no channels";
  throw Error(name, found, "R, G and B, or Y alone, one value a pixel");
}

/// True for Y alone, false for R, G, B; refuses the rest.
bool is_grey(const Imf::ChannelList& channels, const std::string& name) {
  const auto has = [&](const char* channel) {
    const Imf::Channel* const found = channels.findChannel(channel);
    return found != nullptr && found->xSampling == 1 && found->ySampling == 1;
  };
  if (has("R") && has("G") && has("B")) return false;
  if (has("Y") && !channels.findChannel("RY") && !channels.findChannel("BY")) return true;
  fail_channels(channels, name);
}

/// Slices that place channel c of pixel (x, y) at image.at(x, y)[c].
Imf::FrameBuffer frame_buffer(RgbImage& image, const Imath::Box2i& window, bool grey) {
  Imf::FrameBuffer buffer;
  const auto insert = [&](const char* channel, float& first) {
    buffer.insert(channel, Imf::Slice::Make(Imf::FLOAT, &first, window, sizeof(Vec3f),
                                            sizeof(Vec3f) * static_cast<std::size_t>(image.width)));
  };
  if (grey) {
    insert("Y", image.pixels.front().x);
  } else {
    insert("R", image.pixels.front().x);
    insert("G", image.pixels.front().y);
    insert("B", image.pixels.front().z);
  }
  return buffer;
}

RgbImage decode_checked_exr(std::span<const std::byte> bytes, const std::string& name) {
  ByteStream stream(bytes, name);
  Imf::InputFile file(stream, /*numThreads=*/0);
  const Imath::Box2i window = file.header().dataWindow();
  const bool grey = is_grey(file.header().channels(), name);
  if (!file.isComplete()) throw Error(name, "a truncated file", "all rows or tiles");

  RgbImage image(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1);
  file.setFrameBuffer(frame_buffer(image, window, grey));
  file.readPixels(window.min.y, window.max.y);
  if (grey) {
    for (Vec3f& pixel : image.pixels) pixel = Vec3f::filled(pixel.x);
  }
  return image;
}

}  // namespace

RgbImage decode_exr(std::span<const std::byte> bytes, const std::string& name) {
  check_claims(bytes, name);
  try {
    return decode_checked_exr(bytes, name);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {  // Iex::BaseExc, and what OpenEXR lets through
    throw Error(name, quote(error.what()), "a whole OpenEXR picture");
  }
}

void write_exr(const std::filesystem::path& path, const RgbImage& image) {
  RIMLIGHT_CHECK(image.width > 0 && image.height > 0);
  Imf::StdOSStream stream;
  try {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const char* const channel : {"R", "G", "B"}) {
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    }
    Imf::OutputFile file(stream, header, /*numThreads=*/0);
    // OpenEXR's slices are the same for reading and writing, so not const; nothing is written here.
    file.setFrameBuffer(
        frame_buffer(const_cast<RgbImage&>(image), header.dataWindow(), /*grey=*/false));
    file.writePixels(image.height);
  } catch (const Iex::BaseExc& error) {
    throw Error(path.string(), quote(error.what()), "a picture that OpenEXR can write");
  }
  write_file_atomically(path, stream.str());
}

}  // namespace rimlight
