#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

#include "core/image/vp8_codec.h"

namespace rimlight::server {

/// The two pictures that an encoder or a decoder of a stream keeps, by the numbers of the frames
/// that they came with.
struct KeptPictures {
  static constexpr std::int64_t kNone = -1;
  std::int64_t last = kNone, golden = kNone;

  friend bool operator==(const KeptPictures&, const KeptPictures&) = default;
};

/// A frame of a stream: what it is predicted from, and as what it is kept.
struct StreamFrame {
  std::int64_t number = 0;  // in its stream
  Vp8Links links;
  KeptPictures from;  // those that it is predicted from, by name; the others do not matter

  bool can_follow(const KeptPictures& kept) const;
  /// What a decoder keeps after it.
  void keep(KeptPictures& kept) const;
};

/// Plans the frames of one VP8 stream for clients each of which takes frames at its own pace: one
/// is ready for every frame, another, far away, for one in ten. An ordinary frame is predicted from
/// the last one. When somebody who missed that is ready, the frame is predicted from the golden one
/// alone, which all have, and becomes the next golden one, if all who follow the stream will get
/// it. So nobody who keeps following needs a key frame, and nobody's pace costs another one any
/// frames. Who joins, or has neither picture, starts with a key frame; where others follow already,
/// there is one in kKeyInterval at most, and until then those who wait get JPEG.
/// Pure: the encoder is elsewhere. One thread at a time.
class SharedStream {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kKeyInterval{500};

  struct Member {
    KeptPictures kept;      // after what is on its way to it
    bool is_ready = false;  // will get the frame at once
    bool can_owe = false;   // else: will get it next, if it must
  };
  /// A new picture goes to all; a repeated one to those that are ready, and changes nothing.
  enum class Kind { new_picture, repeat };

  /// Nothing when none of those who are ready can follow, and it is too early for a key frame.
  std::optional<StreamFrame> plan(std::span<const Member> members, Kind kind,
                                  Clock::time_point now) const;
  /// The encoder made it: from now on it is what later frames are predicted from.
  void made(const StreamFrame& frame, Clock::time_point now);
  /// The encoder failed: the next frame is a key frame.
  void lost() { kept_ = {}; }

  const KeptPictures& kept() const { return kept_; }
  bool follows(const KeptPictures& kept) const;

 private:
  StreamFrame frame_of(const Vp8Links& links) const;

  KeptPictures kept_;  // the encoder's
  std::int64_t made_ = 0;
  std::optional<Clock::time_point> last_key_;
};

}  // namespace rimlight::server
