#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <type_traits>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/image/codec.h"
#include "core/image/image_size.h"

namespace rimlight {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr int kMcuSide = 16;      // pixels of a minimum coded unit, 4:2:0
constexpr int kLeastMcuRows = 4;  // of a stripe: fewer are not worth a thread's while
constexpr int kWantedStripes = 8;
constexpr int kMostInterval = 65'535;  // of minimum coded units, between restarts

// Markers of a JPEG file (ITU-T T.81, table B.1), after their 0xff.
constexpr std::uint8_t kStartOfFrame = 0xc0, kRestart = 0xd0, kEnd = 0xd9, kStartOfScan = 0xda,
                       kRestartInterval = 0xdd;

constexpr int divide_up(int a, int b) { return (a + b - 1) / b; }

/// Rows of pixels of all stripes but the last, a multiple of kMcuSide.
int stripe_height(int width, int height) {
  const int mcu_rows = divide_up(height, kMcuSide);
  const int wanted = std::max(kLeastMcuRows, divide_up(mcu_rows, kWantedStripes));
  return std::min(wanted, kMostInterval / divide_up(width, kMcuSide)) * kMcuSide;
}

std::size_t big_endian(Bytes bytes, std::size_t at) {
  return std::size_t{bytes[at]} << 8 | bytes[at + 1];
}

void append(std::vector<std::uint8_t>& to, Bytes bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

/// Where the parts of a file that libjpeg-turbo wrote begin.
struct Layout {
  std::size_t height = 0;  // the picture's, two bytes
  std::size_t scan = 0;    // the scan's marker
  std::size_t codes = 0;   // what the entropy coder wrote; up to the end marker
};

Layout find_layout(Bytes file) {
  Layout layout;
  for (std::size_t at = 2;; at += 2 + big_endian(file, at + 2)) {
    RIMLIGHT_CHECK(at + 4 <= file.size() && file[at] == 0xff);
    if (file[at + 1] == kStartOfFrame) layout.height = at + 5;
    if (file[at + 1] != kStartOfScan) continue;
    layout.scan = at;
    layout.codes = at + 2 + big_endian(file, at + 2);
    RIMLIGHT_CHECK(layout.height > 0 && layout.codes + 2 <= file.size());
    return layout;
  }
}

}  // namespace

/// Compresses some rows of a picture as a file of their own.
class JpegEncoder::Stripe {
 public:
  Stripe() : compressor_(tjInitCompress(), &tjDestroy) { RIMLIGHT_CHECK(compressor_ != nullptr); }

  void encode(const std::uint8_t* rows, int width, int height, int quality) {
    // The largest size that libjpeg-turbo can need: with it, it never reallocates.
    buffer_.resize(tjBufSize(width, height, TJSAMP_420));
    unsigned char* to = buffer_.data();
    size_ = buffer_.size();
    if (tjCompress2(compressor_.get(), rows, width, /*pitch=*/0, height, TJPF_RGB, &to, &size_,
                    TJSAMP_420, quality, TJFLAG_NOREALLOC) != 0) {
      throw Error("JPEG", tjGetErrorStr2(compressor_.get()), "an image that can be compressed");
    }
  }

  Bytes file() const { return Bytes(buffer_).first(size_); }
  /// What the entropy coder wrote.
  Bytes codes() const {
    const Bytes whole = file();
    const std::size_t first = find_layout(whole).codes;
    return whole.subspan(first, whole.size() - 2 - first);
  }

 private:
  std::unique_ptr<std::remove_pointer_t<tjhandle>, decltype(&tjDestroy)> compressor_;
  std::vector<std::uint8_t> buffer_;
  unsigned long size_ = 0;
};

JpegEncoder::JpegEncoder() = default;
JpegEncoder::~JpegEncoder() = default;

void JpegEncoder::encode(const Rgb8Image& image, int quality, std::vector<std::uint8_t>& jpeg) {
  RIMLIGHT_CHECK(image.width > 0 && image.height > 0);
  RIMLIGHT_CHECK_EQ(image.bytes.size(), static_cast<std::size_t>(image.width) *
                                            static_cast<std::size_t>(image.height) * 3);
  RIMLIGHT_CHECK(quality >= 1 && quality <= 100);
  const int rows = stripe_height(image.width, image.height);
  const auto count = static_cast<std::size_t>(divide_up(image.height, rows));
  while (stripes_.size() < count) stripes_.push_back(std::make_unique<Stripe>());
  parallel_for(count, [&](std::size_t i) {
    const int top = static_cast<int>(i) * rows;
    const std::size_t first = static_cast<std::size_t>(top) * static_cast<std::size_t>(image.width);
    stripes_[i]->encode(image.bytes.data() + 3 * first, image.width,
                        std::min(rows, image.height - top), quality);
  });
  if (count == 1) {
    const Bytes whole = stripes_.front()->file();
    jpeg.assign(whole.begin(), whole.end());
  } else {
    join(count, image.height, divide_up(image.width, kMcuSide) * (rows / kMcuSide), jpeg);
  }
}

void JpegEncoder::join(std::size_t count, int height, int interval,
                       std::vector<std::uint8_t>& jpeg) const {
  const Bytes first = stripes_.front()->file();
  const Layout layout = find_layout(first);
  jpeg.assign(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(layout.scan));
  jpeg[layout.height] = static_cast<std::uint8_t>(height >> 8);
  jpeg[layout.height + 1] = static_cast<std::uint8_t>(height & 0xff);
  append(jpeg, std::array<std::uint8_t, 6>{0xff, kRestartInterval, 0, 4,
                                           static_cast<std::uint8_t>(interval >> 8),
                                           static_cast<std::uint8_t>(interval & 0xff)});
  append(jpeg, first.subspan(layout.scan, layout.codes - layout.scan));
  for (std::size_t i = 0; i < count; ++i) {
    append(jpeg, stripes_[i]->codes());
    const bool last = i + 1 == count;
    const std::uint8_t marker = last ? kEnd : static_cast<std::uint8_t>(kRestart + i % 8);
    append(jpeg, std::array<std::uint8_t, 2>{0xff, marker});
  }
}

Rgb8Image decode_jpeg(const std::uint8_t* bytes, std::size_t size, std::string_view source) {
  const std::unique_ptr<std::remove_pointer_t<tjhandle>, decltype(&tjDestroy)> decompressor(
      tjInitDecompress(), &tjDestroy);
  RIMLIGHT_CHECK(decompressor != nullptr);
  const auto fail = [&] {
    throw Error(std::string(source), quote(tjGetErrorStr2(decompressor.get())),
                "a whole JPEG picture");
  };
  int width = 0;
  int height = 0;
  int subsampling = 0;
  int colour_space = 0;
  if (tjDecompressHeader3(decompressor.get(), bytes, size, &width, &height, &subsampling,
                          &colour_space) != 0) {
    fail();
  }
  check_image_size(width, height, std::string(source));

  Rgb8Image image(width, height);
  // A warning means damage, and too many progressive scans an attack on our time.
  if (tjDecompress2(decompressor.get(), bytes, size, image.bytes.data(), width, /*pitch=*/0, height,
                    TJPF_RGB, TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS) != 0) {
    fail();
  }
  return image;
}

}  // namespace rimlight
