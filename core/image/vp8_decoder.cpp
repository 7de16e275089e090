#include <libyuv/convert_argb.h>
#include <libyuv/convert_from.h>
#include <vpx/vp8dx.h>
#include <vpx/vpx_decoder.h>

#include <limits>
#include <string>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/image/image_size.h"
#include "core/image/vp8_codec.h"

namespace rimlight {

class Vp8Decoder::State {
 public:
  State() { RIMLIGHT_CHECK(vpx_codec_dec_init(&codec_, interface(), nullptr, 0) == VPX_CODEC_OK); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { vpx_codec_destroy(&codec_); }

  void decode(std::span<const std::uint8_t> frame, const std::string& source, Rgb8Image& picture) {
    check_start(frame, source);
    const auto size = static_cast<unsigned>(frame.size());
    if (vpx_codec_decode(&codec_, frame.data(), size, nullptr, 0) != VPX_CODEC_OK) {
      const char* const detail = vpx_codec_error_detail(&codec_);
      throw Error(source, quote(detail != nullptr ? detail : vpx_codec_error(&codec_)),
                  "a whole VP8 frame");
    }
    vpx_codec_iter_t at = nullptr;
    const vpx_image_t* const decoded = vpx_codec_get_frame(&codec_, &at);
    int is_damaged = 0;
    vpx_codec_control(&codec_, VP8D_GET_FRAME_CORRUPTED, &is_damaged);
    if (decoded == nullptr || is_damaged != 0) {
      throw Error(source, "a frame that is damaged or not shown", "a whole VP8 frame");
    }
    picture.resize(static_cast<int>(decoded->d_w), static_cast<int>(decoded->d_h));
    libyuv::I420ToRAW(decoded->planes[0], decoded->stride[0], decoded->planes[1],
                      decoded->stride[1], decoded->planes[2], decoded->stride[2],
                      picture.bytes.data(), 3 * picture.width, picture.width, picture.height);
  }

 private:
  static vpx_codec_iface_t* interface() { return vpx_codec_vp8_dx(); }

  /// Sizes of a key frame, before libvpx allocates for them; no other frame before one.
  void check_start(std::span<const std::uint8_t> frame, const std::string& source) {
    constexpr std::size_t kLeast = 3, kLeastOfKey = 10;  // RFC 6386, section 9.1
    if (frame.size() < kLeast || frame.size() > std::numeric_limits<unsigned>::max()) {
      throw Error(source, std::to_string(frame.size()) + " bytes", "a VP8 frame");
    }
    const bool is_key = (frame[0] & 1) == 0;
    if (!is_key) {
      if (!has_started_) throw Error(source, "a frame that depends on others", "a key frame first");
      return;
    }
    if (frame.size() < kLeastOfKey) {
      throw Error(source, std::to_string(frame.size()) + " bytes", "a whole key frame");
    }
    check_image_size((frame[6] | frame[7] << 8) & 0x3fff, (frame[8] | frame[9] << 8) & 0x3fff,
                     source);
    has_started_ = true;
  }

  vpx_codec_ctx_t codec_{};
  bool has_started_ = false;
};

Vp8Decoder::Vp8Decoder() : state_(std::make_unique<State>()) {}
Vp8Decoder::~Vp8Decoder() = default;

void Vp8Decoder::decode(std::span<const std::uint8_t> frame, std::string_view source,
                        Rgb8Image& picture) {
  state_->decode(frame, std::string(source), picture);
}

}  // namespace rimlight
