#include <turbojpeg.h>

#include <memory>
#include <type_traits>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/image/codec.h"
#include "core/image/image_size.h"

namespace rimlight {

JpegEncoder::JpegEncoder() : compressor_(tjInitCompress()) {
  RIMLIGHT_CHECK(compressor_ != nullptr);
}

JpegEncoder::~JpegEncoder() { tjDestroy(compressor_); }

void JpegEncoder::encode(const Rgb8Image& image, int quality, std::vector<std::uint8_t>& jpeg) {
  RIMLIGHT_CHECK(image.width > 0 && image.height > 0);
  RIMLIGHT_CHECK_EQ(image.bytes.size(), static_cast<std::size_t>(image.width) *
                                            static_cast<std::size_t>(image.height) * 3);
  RIMLIGHT_CHECK(quality >= 1 && quality <= 100);
  // The largest size that libjpeg-turbo can need: with it, it never reallocates.
  buffer_.resize(tjBufSize(image.width, image.height, TJSAMP_420));
  unsigned char* to = buffer_.data();
  unsigned long size = buffer_.size();
  if (tjCompress2(compressor_, image.bytes.data(), image.width, /*pitch=*/0, image.height, TJPF_RGB,
                  &to, &size, TJSAMP_420, quality, TJFLAG_NOREALLOC) != 0) {
    throw Error("JPEG", tjGetErrorStr2(compressor_), "an image that can be compressed");
  }
  jpeg.assign(buffer_.data(), buffer_.data() + size);
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
