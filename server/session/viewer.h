#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "server/delivery/delay_meter.h"
#include "server/delivery/encoded_frame.h"
#include "server/delivery/ladder.h"
#include "server/session/client.h"

namespace rimlight::server {

/// Why a client's frame_ack was not taken.
enum class AckResult { taken, not_in_flight };

/// One client of a session, and its place in the flow of frames: at most one frame, or part of one,
/// is on its way to it. From when that was sent to its acknowledgement is measured, and the rung of
/// its next frames follows from it, and from nothing else. One thread at a time: the session's
/// mutex.
class Viewer {
 public:
  using Clock = DelayMeter::Clock;

  /// width × height: of the session's pictures.
  Viewer(std::shared_ptr<Client> client, std::int64_t number, int width, int height);

  std::shared_ptr<Client> client;
  std::int64_t number = 0;  // of those that have joined, from 1
  bool only_watches = false;

  void set_display(const Display& display);
  bool is_hidden() const { return display_.hidden; }
  /// Whether it could be sent a frame at once.
  bool is_ready() const { return !display_.hidden && !in_flight_; }
  /// Whether it lags behind the picture of this number.
  bool lacks(std::int64_t frame) const { return shown_ < frame; }
  std::size_t rung() const { return climber_.rung(); }
  /// Whether it takes part in the stream of a VP8 rung: it may pause, but not for long.
  bool is_member(std::size_t rung, Clock::time_point now) const;
  SharedStream::Member as_member() const;
  /// Whether it has what the frame is predicted from, and wants its like. `has_stream`: it follows
  /// the stream of its rung, and wants no JPEG. Of previews, whether it is on their rung.
  bool accepts(const EncodedFrame& frame, bool has_stream) const;
  /// Whether a lossless image of that many bytes would go to it in parts.
  bool would_split(std::size_t bytes) const { return display_.parts && bytes > parts_.bytes(); }
  /// Whether it has seen nothing of that revision, not even roughly.
  bool has_not_seen(const Revision& revision) const { return seen_ < revision; }
  /// Of JPEG, for its first look at a picture that comes in parts.
  std::size_t preview_rung() const;
  const KeptPictures& kept() const { return kept_; }

  /// It must be ready.
  void send(const EncodedPtr& frame, Clock::time_point now);
  /// Sent as soon as it is ready, before any other: it is needed for later ones.
  void owe(const EncodedPtr& frame) { owed_ = frame; }
  /// The rest of a frame in parts goes on, unless `newest` is later than what it shows. Sends what
  /// is owed.
  [[nodiscard]] AckResult acknowledge(std::int64_t frame, const Revision& newest,
                                      Clock::time_point now);

 private:
  struct InFlight {
    EncodedPtr frame;
    std::size_t bytes = 0;  // of the message
    std::size_t end = 0;    // of the part, in the payload
    Clock::time_point sent;
  };

  void send_part(const EncodedPtr& frame, std::size_t offset, Clock::time_point now);
  void leave_stream();
  void measure(const InFlight& acknowledged, Clock::time_point now);

  int width_, height_;
  Display display_;
  LadderClimber climber_;
  DelayMeter meter_;
  std::optional<InFlight> in_flight_;
  PartSizer parts_;
  EncodedPtr owed_;
  KeptPictures kept_;        // by its decoder, after what is in flight
  std::int64_t shown_ = -1;  // the newest picture that it was sent, other than as a preview
  Revision seen_;            // the newest that it was sent a picture of
};

}  // namespace rimlight::server
