#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/image/vp8_codec.h"
#include "core/math/random.h"
#include "tests/core/image/encoded_pictures.h"
#include "tests/support/allocation_count.h"
#include "tests/support/error_of.h"

namespace rimlight {
namespace {

using ::testing::HasSubstr;
using namespace test;  // NOLINT: the makers of pictures

using Bytes = std::vector<std::uint8_t>;
constexpr Vp8Links kKey{};
constexpr Vp8Links kNext{.from_last = true, .from_golden = true};

/// Shades that turn with time, behind edges that stay: a relit scene.
Rgb8Image lit_picture(int width, int height, double turn) {
  Rgb8Image image(width, height);
  std::size_t i = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double edge = (x / 61 + y / 83) % 2 == 0 ? 0.6 : 1;
      for (int c = 0; c < 3; ++c) {
        const double shade = 0.5 + 0.45 * std::sin(0.01 * x + 0.013 * y + turn + 0.1 * c);
        image.bytes[i++] = static_cast<std::uint8_t>(255 * edge * shade);
      }
    }
  }
  return image;
}

double psnr(const Rgb8Image& a, const Rgb8Image& b) {
  if (a.bytes.size() != b.bytes.size()) return 0;
  double sum = 0;
  for (std::size_t i = 0; i < a.bytes.size(); ++i) {
    const double difference = a.bytes[i] - b.bytes[i];
    sum += difference * difference;
  }
  return 10 * std::log10(255 * 255 * static_cast<double>(a.bytes.size()) / sum);
}

Bytes encode(Vp8Encoder& encoder, const Rgb8Image& picture, const Vp8Links& links) {
  Bytes frame;
  encoder.encode(picture, links, frame);
  return frame;
}

Rgb8Image decode(Vp8Decoder& decoder, const Bytes& frame) {
  Rgb8Image picture;
  decoder.decode(frame, "a.vp8", picture);
  return picture;
}

bool is_key(const Bytes& frame) { return (frame.at(0) & 1) == 0; }

class Vp8 : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_vp8()) GTEST_SKIP() << "a build without VP8";
  }
};

TEST_F(Vp8, AStreamLooksLikeItsPicturesAndIsFarSmallerThanKeyFrames) {
  Vp8Encoder encoder(256, 192, 12);
  Vp8Decoder decoder;
  std::size_t key_bytes = 0, others = 0;
  for (int i = 0; i < 20; ++i) {
    const Rgb8Image picture = lit_picture(256, 192, 0.02 * i);
    const Bytes frame = encode(encoder, picture, i == 0 ? kKey : kNext);
    EXPECT_EQ(is_key(frame), i == 0);
    (i == 0 ? key_bytes : others) += frame.size();
    EXPECT_GT(psnr(decode(decoder, frame), picture), 36) << "frame " << i;
  }
  EXPECT_LT(others / 19, key_bytes / 2);
}

TEST_F(Vp8, AnySizeKeepsItsSizeAndLook) {
  for (const auto& [width, height] :
       {std::pair(1, 1), {1, 7}, {17, 1}, {2, 2}, {33, 17}, {129, 65}, {16383, 3}}) {
    Vp8Encoder encoder(width, height, 8);
    Vp8Decoder decoder;
    const Rgb8Image picture = lit_picture(width, height, 0);
    for (const Vp8Links& links : {kKey, kNext}) {
      const Rgb8Image read = decode(decoder, encode(encoder, picture, links));
      ASSERT_EQ(read.width, width);
      ASSERT_EQ(read.height, height);
      EXPECT_GT(psnr(read, picture), 30) << width << " × " << height;
    }
  }
}

TEST_F(Vp8, AFinerQuantizerIsCloserAndLarger) {
  double last_psnr = 0;
  std::size_t last_size = 0;
  const Rgb8Image picture = lit_picture(256, 192, 1);
  for (const int quantizer : {63, 40, 20, 8, 0}) {
    Vp8Encoder encoder(256, 192, quantizer);
    Vp8Decoder decoder;
    const Bytes frame = encode(encoder, picture, kKey);
    const double now = psnr(decode(decoder, frame), picture);
    EXPECT_GT(now, last_psnr) << quantizer;
    EXPECT_GT(frame.size(), last_size) << quantizer;
    last_psnr = now;
    last_size = frame.size();
  }
}

TEST_F(Vp8, AKeyFrameOnRequestStartsANewDecoder) {
  Vp8Encoder encoder(128, 96, 12);
  (void)encode(encoder, lit_picture(128, 96, 0), kKey);
  const Bytes second = encode(encoder, lit_picture(128, 96, 0.1), kNext);
  const Rgb8Image third_picture = lit_picture(128, 96, 0.2);
  const Bytes third = encode(encoder, third_picture, kKey);
  EXPECT_TRUE(is_key(third));
  Vp8Decoder late;
  EXPECT_THAT(error_of([&] { decode(late, second); }), HasSubstr("a key frame first"));
  EXPECT_GT(psnr(decode(late, third), third_picture), 36);
}

/// What a decoder keeps: which frame is its last, and which its golden one.
struct Kept {
  std::optional<int> last, golden;
};

// The heart of sharing a stream: a decoder that gets any part of the frames shows, bit for bit,
// what one that gets all of them shows, as long as it has the pictures that its frames are
// predicted from, and no others.
TEST_F(Vp8, ADecoderNeedsOnlyThePicturesThatAFrameNames) {
  constexpr int kWidth = 80, kHeight = 64, kFrames = 300, kDecoders = 4;
  Random random(7);
  Vp8Encoder encoder(kWidth, kHeight, 16);
  Vp8Decoder whole;
  std::array<Vp8Decoder, kDecoders> decoders;
  std::array<Kept, kDecoders> kept;
  Kept encoder_kept;
  int decoded = 0, behind = 0;
  for (int i = 0; i < kFrames; ++i) {
    Vp8Links links{random.below(3) != 0, random.below(3) != 0, random.below(4) != 0,
                   random.below(70) == 0};  // rare: the encoder must not do it by itself
    if (i == 0) links = kKey;
    if (links.is_key() && i > 0 && random.below(4) != 0) links.from_last = true;
    const Bytes frame = encode(encoder, lit_picture(kWidth, kHeight, 0.05 * i), links);
    ASSERT_EQ(is_key(frame), links.is_key());
    const Rgb8Image shown = decode(whole, frame);
    for (std::size_t d = 0; d < kDecoders; ++d) {
      const bool can = (!links.from_last || kept[d].last == encoder_kept.last) &&
                       (!links.from_golden || kept[d].golden == encoder_kept.golden) &&
                       (links.is_key() || kept[d].last || kept[d].golden);
      if (!can || random.below(3) == 0) continue;
      ASSERT_EQ(decode(decoders[d], frame).bytes, shown.bytes) << "frame " << i;
      ++decoded;
      behind += kept[d].last != encoder_kept.last && !links.is_key();
      if (links.to_last || links.is_key()) kept[d].last = i;
      if (links.to_golden || links.is_key()) kept[d].golden = i;
    }
    if (links.to_last || links.is_key()) encoder_kept.last = i;
    if (links.to_golden || links.is_key()) encoder_kept.golden = i;
  }
  EXPECT_GT(decoded, 100);
  EXPECT_GT(behind, 10);  // frames that named the golden one alone
}

TEST_F(Vp8, AllocatesNothingAfterTheFirstFrames) {
  if (!kCountsAllocations) GTEST_SKIP() << "ThreadSanitizer keeps operator new to itself";
  Vp8Encoder encoder(160, 120, 12);
  Bytes frame;
  const Rgb8Image first = random_bytes_image(160, 120, 1);  // the largest frame
  const std::size_t before = allocation_count();
  encoder.encode(first, kKey, frame);
  const std::size_t warm = allocation_count();
  EXPECT_GT(warm, before);
  const Rgb8Image picture = lit_picture(160, 120, 0);
  for (int i = 0; i < 10; ++i) encoder.encode(picture, i == 5 ? kKey : kNext, frame);
  EXPECT_LT(frame.size(), frame.capacity());
  const std::size_t after = allocation_count();
  EXPECT_LE(after, warm + 2);  // the two pictures
}

TEST_F(Vp8, HostileParametersAreErrors) {
  EXPECT_THAT(error_of([] { Vp8Encoder(0, 8, 8); }), HasSubstr("VP8 width: found 0"));
  EXPECT_THAT(error_of([] { Vp8Encoder(8, 16384, 8); }), HasSubstr("VP8 height: found 16384"));
  EXPECT_THAT(error_of([] { Vp8Encoder(8, -5, 8); }), HasSubstr("found -5"));
  EXPECT_THAT(error_of([] { Vp8Encoder(8, 8, 64); }), HasSubstr("VP8 quantizer: found 64"));
  EXPECT_THAT(error_of([] { Vp8Encoder(8, 8, -1); }), HasSubstr("0 … 63"));
  Vp8Encoder encoder(8, 8, 8);
  Bytes frame;
  EXPECT_THROW(encoder.encode(lit_picture(8, 8, 0), kNext, frame), std::logic_error);
  EXPECT_THROW(encoder.encode(lit_picture(8, 9, 0), kKey, frame), std::logic_error);
}

TEST_F(Vp8, DamagedFramesAreErrorsOrPictures) {
  Vp8Encoder encoder(70, 50, 12);
  const Bytes key = encode(encoder, lit_picture(70, 50, 0), kKey);
  const Bytes next = encode(encoder, lit_picture(70, 50, 0.1), kNext);
  Random random(3);
  int refused = 0;
  for (int trial = 0; trial < 600; ++trial) {
    Vp8Decoder decoder;
    if (trial % 2 == 1) (void)decode(decoder, key);
    Bytes frame = trial % 2 == 1 ? next : key;
    if (trial % 3 == 0) frame.resize(random.below(frame.size()));
    if (!frame.empty() && trial % 3 != 0) {
      frame[random.below(std::min<std::size_t>(frame.size(), 24))] ^=
          static_cast<std::uint8_t>(1 + random.below(255));
    }
    try {
      const Rgb8Image picture = decode(decoder, frame);
      ASSERT_EQ(picture.bytes.size(), static_cast<std::size_t>(picture.width) *
                                          static_cast<std::size_t>(picture.height) * 3);
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(Vp8Support, IsThereOrABuildWithoutItSaysSo) {
  if (has_vp8()) {
    EXPECT_NO_THROW(Vp8Encoder(8, 8, 8));
    return;
  }
  EXPECT_THAT(error_of([] { Vp8Encoder(8, 8, 8); }), HasSubstr("RIMLIGHT_VP8=ON"));
  EXPECT_THAT(error_of([] { Vp8Decoder(); }), HasSubstr("RIMLIGHT_VP8=ON"));
}

}  // namespace
}  // namespace rimlight
