#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "server/protocol/display_message.h"
#include "server/protocol/frame_message.h"

namespace rimlight::server {

/// How frames in motion are encoded. All clients of a session on one rung share its encodes: of
/// VP8, a stream.
struct Rung {
  Codec codec = Codec::jpeg;
  int quality = 80;  // of JPEG 1 … 100, more is better; of VP8 the quantizer 0 … 63, less is
  int divisor = 1;   // of both sides
  double kilobytes = 26;  // about, of a frame at 512 × 512: what a step is expected to change
};

/// All rungs, in the order of their numbers in frame headers: VP8's three, then JPEG's.
inline constexpr std::array<Rung, 7> kRungs{{
    {Codec::vp8, 12, 1, 6},
    {Codec::vp8, 24, 1, 3},
    {Codec::vp8, 28, 2, 1},
    {Codec::jpeg, 80, 1, 26},
    {Codec::jpeg, 55, 1, 15},
    {Codec::jpeg, 55, 2, 5},
    {Codec::jpeg, 35, 4, 1.4},
}};
inline constexpr std::size_t kVp8Rungs = 3;  // the most streams of a session
/// What a client on a VP8 rung gets while it has no stream: about as good.
constexpr std::size_t jpeg_instead_of(std::size_t rung) { return rung + kVp8Rungs; }

/// The rungs for a client, as a range of kRungs: VP8's, or JPEG's. A client whose frames must be
/// smaller than those of VP8's smallest rung is outside every stream: JPEG's.
struct RungRange {
  std::size_t first = kVp8Rungs;  // where most_pixels allows to begin
  std::size_t end = kRungs.size();

  friend bool operator==(const RungRange&, const RungRange&) = default;
};
RungRange rungs_for(const Display& display, int width, int height);

/// One client's place on its rungs, by the queue delay of its own frames alone. Down at once when a
/// smoothed delay is over the bound, or two in a row are far over it. Up by one step when it has
/// been calm for some seconds and the larger frames are expected to stay well within the bound; a
/// step up that is soon taken back doubles the patience for the next, so that a client settles.
/// Pure: time comes from outside.
class LadderClimber {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr double kMostQueueMs = 50;

  explicit LadderClimber(RungRange range) : range_(range), rung_(range.first) {}

  /// In kRungs.
  std::size_t rung() const { return rung_; }
  /// Keeps its height where it can; another codec begins at the top.
  void set_range(RungRange range);
  /// A frame in motion that was sent on `rung` was acknowledged; `queue_ms` as DelayMeter says.
  void record(std::size_t rung, double queue_ms, Clock::time_point now);
  /// What the link takes for a byte, as other messages have shown: while nothing was sent on its
  /// rung, it goes down to one whose frames are expected to be not far over the bound. `share`: of
  /// the picture's pixels to those of 512 × 512.
  void expect(double ms_per_byte, double share);

 private:
  void move_to(std::size_t rung, Clock::time_point now);

  RungRange range_;
  std::size_t rung_;
  double smoothed_ms_ = 0;
  int samples_ = 0;   // on this rung
  int far_over_ = 0;  // in a row
  std::optional<Clock::time_point> calm_since_, risen_;
  std::chrono::milliseconds patience_{2000};
};

/// How large the parts are in which one client gets a lossless frame: each is to take about as long
/// as a queue delay may be, so that an edit's frame waits no longer behind one. Of a link that
/// nothing is known of they begin small, since the first may meet one of any width, and grow by
/// what has been seen to pass; of one whose time for a byte is known they follow that. A narrow
/// link's are no smaller than kSmallest, of which the headers are a tenth. Pure.
class PartSizer {
 public:
  static constexpr std::size_t kSmallest = 4 * 1024, kLargest = 4 * 1024 * 1024;

  /// A message of `bytes`, a part or any other, was acknowledged after `delay_ms`, of which
  /// `queue_ms` was more than an empty one takes; `ms_per_byte` as DelayMeter knows it, 0: not.
  void record(std::size_t bytes, double delay_ms, double queue_ms, double ms_per_byte);
  std::size_t bytes() const { return bytes_; }

 private:
  std::size_t bytes_ = kSmallest;
};

/// The rung of JPEG for a first look at a picture whose lossless form takes many parts: the best
/// from `first` on that is expected to take no longer than one; else the smallest. width × height:
/// of the picture.
std::size_t preview_rung(std::size_t part_bytes, std::size_t first, int width, int height);

}  // namespace rimlight::server
