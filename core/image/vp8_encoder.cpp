#include <libyuv/convert.h>
#include <vpx/vp8cx.h>
#include <vpx/vpx_encoder.h>

#include <algorithm>
#include <string>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/image/vp8_codec.h"

namespace rimlight {
namespace {

/// Of 0 … 16: the larger, the less is searched. Slower ones cost 1.5 times the time for 2 % of the
/// bytes.
constexpr int kSpeed = 8;
/// A rate that nothing here reaches: the quantizer alone decides.
constexpr unsigned kKilobitsPerSecond = 1'000'000;
constexpr int kTicksPerSecond = 90'000;

void check(bool is_fine, const char* what, int found, const std::string& expected) {
  if (!is_fine) throw Error(what, std::to_string(found), expected);
}

vpx_codec_enc_cfg_t configuration_of(int width, int height, int quantizer) {
  vpx_codec_enc_cfg_t c{};
  RIMLIGHT_CHECK(vpx_codec_enc_config_default(vpx_codec_vp8_cx(), &c, 0) == VPX_CODEC_OK);
  c.g_w = static_cast<unsigned>(width);
  c.g_h = static_cast<unsigned>(height);
  c.g_threads = 1;
  c.g_timebase = {1, kTicksPerSecond};
  c.g_lag_in_frames = 0;
  c.g_pass = VPX_RC_ONE_PASS;
  // Without it the encoder replaces the golden picture by itself from time to time, whatever the
  // flags of a frame say, and a decoder that misses that frame goes wrong.
  c.g_error_resilient = VPX_ERROR_RESILIENT_DEFAULT;
  c.rc_end_usage = VPX_CBR;
  c.rc_target_bitrate = kKilobitsPerSecond;
  c.rc_min_quantizer = c.rc_max_quantizer = static_cast<unsigned>(quantizer);
  c.rc_dropframe_thresh = 0;
  c.rc_resize_allowed = 0;
  c.kf_mode = VPX_KF_DISABLED;
  return c;
}

vpx_enc_frame_flags_t flags_of(const Vp8Links& links) {
  if (links.is_key()) return VPX_EFLAG_FORCE_KF;
  vpx_enc_frame_flags_t flags =
      VP8_EFLAG_NO_REF_ARF | VP8_EFLAG_NO_UPD_ARF | VP8_EFLAG_NO_UPD_ENTROPY;
  if (!links.from_last) flags |= VP8_EFLAG_NO_REF_LAST;
  if (!links.from_golden) flags |= VP8_EFLAG_NO_REF_GF;
  if (!links.to_last) flags |= VP8_EFLAG_NO_UPD_LAST;
  if (!links.to_golden) flags |= VP8_EFLAG_NO_UPD_GF;
  return flags;
}

}  // namespace

bool has_vp8() { return true; }

class Vp8Encoder::State {
 public:
  State(int width, int height, int quantizer) : width_(width), height_(height) {
    const vpx_codec_enc_cfg_t configuration = configuration_of(width, height, quantizer);
    if (vpx_img_alloc(&picture_, VPX_IMG_FMT_I420, configuration.g_w, configuration.g_h, 32) ==
        nullptr) {
      throw Error("VP8", "no memory for a picture", "some");
    }
    if (vpx_codec_enc_init(&codec_, vpx_codec_vp8_cx(), &configuration, 0) != VPX_CODEC_OK) {
      vpx_img_free(&picture_);
      throw Error("VP8", vpx_codec_error(&codec_), "an encoder for such pictures");
    }
    set(VP8E_SET_CPUUSED, -kSpeed);  // negative: that speed, whatever the time it takes
    set(VP8E_SET_ENABLEAUTOALTREF, 0);
    set(VP8E_SET_NOISE_SENSITIVITY, 0);
    set(VP8E_SET_STATIC_THRESHOLD, 0);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    vpx_codec_destroy(&codec_);
    vpx_img_free(&picture_);
  }

  void encode(const Rgb8Image& picture, const Vp8Links& links, std::vector<std::uint8_t>& frame) {
    RIMLIGHT_CHECK_EQ(picture.width, width_);
    RIMLIGHT_CHECK_EQ(picture.height, height_);
    RIMLIGHT_CHECK(links.is_key() || time_ > 0);
    // libyuv calls bytes in the order R, G, B "RAW".
    libyuv::RAWToI420(picture.bytes.data(), 3 * width_, picture_.planes[0], picture_.stride[0],
                      picture_.planes[1], picture_.stride[1], picture_.planes[2],
                      picture_.stride[2], width_, height_);
    const vpx_codec_pts_t now = time_;
    time_ += kTicksPerSecond / 60;
    if (vpx_codec_encode(&codec_, &picture_, now, kTicksPerSecond / 60, flags_of(links),
                         VPX_DL_REALTIME) != VPX_CODEC_OK) {
      throw Error("VP8", vpx_codec_error(&codec_), "a picture that can be compressed");
    }
    frame.clear();
    vpx_codec_iter_t at = nullptr;
    while (const vpx_codec_cx_pkt_t* const packet = vpx_codec_get_cx_data(&codec_, &at)) {
      if (packet->kind != VPX_CODEC_CX_FRAME_PKT) continue;
      const auto* const bytes = static_cast<const std::uint8_t*>(packet->data.frame.buf);
      frame.insert(frame.end(), bytes, bytes + packet->data.frame.sz);
    }
    RIMLIGHT_CHECK(!frame.empty());
  }

 private:
  void set(int control, int value) {
    RIMLIGHT_CHECK(vpx_codec_control_(&codec_, control, value) == VPX_CODEC_OK);
  }

  const int width_, height_;
  vpx_image_t picture_{};
  vpx_codec_ctx_t codec_{};
  vpx_codec_pts_t time_ = 0;
};

Vp8Encoder::Vp8Encoder(int width, int height, int quantizer) {
  const std::string side = "1 … " + std::to_string(kLargestSide);
  check(width >= 1 && width <= kLargestSide, "VP8 width", width, side);
  check(height >= 1 && height <= kLargestSide, "VP8 height", height, side);
  check(quantizer >= 0 && quantizer <= kCoarsest, "VP8 quantizer", quantizer,
        "0 … " + std::to_string(kCoarsest));
  state_ = std::make_unique<State>(width, height, quantizer);
}
Vp8Encoder::~Vp8Encoder() = default;

void Vp8Encoder::encode(const Rgb8Image& picture, const Vp8Links& links,
                        std::vector<std::uint8_t>& frame) {
  state_->encode(picture, links, frame);
}

}  // namespace rimlight
