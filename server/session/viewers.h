#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "server/delivery/shared_stream.h"
#include "server/session/viewer.h"

namespace rimlight::server {

/// The clients of a session, and what is encoded for them: each picture once for all on a rung, at
/// most three VP8 streams. What waits for a client that cannot take a frame yet is not a frame but
/// that it lacks the newest picture: an encode of it that others got, or one that is made when it
/// is ready. So a slow client gets fewer frames, never older ones, and always the last. Whom a
/// lossless picture would reach in parts, and who has seen nothing of its revision, gets a small
/// JPEG of it first: a preview. One thread at a time: the session's mutex.
class Viewers {
 public:
  using Viewer = server::Viewer;
  using Clock = Viewer::Clock;

  /// width × height: of the session's pictures.
  Viewers(int width, int height) : width_(width), height_(height) {}

  bool empty() const { return viewers_.empty(); }
  auto begin() const { return viewers_.begin(); }
  auto end() const { return viewers_.end(); }

  /// Who may only watch comes second under overload.
  enum class Part { edits, watches };
  void join(const std::shared_ptr<Client>& client, Part part = Part::edits,
            const Display& display = {});
  void leave(const Client& client);
  /// Nothing when it has left.
  const Viewer* find(const Client& client) const;
  /// One that shows again gets the newest picture, if that is of the newest revision.
  void set_display(const Client& client, const Display& display, Clock::time_point now);
  /// The newest revision is this: what shows an older one is not worth going on with.
  void expect(const Revision& revision) { expected_ = revision; }

  /// Whether those who may only watch get exact pictures alone.
  void set_editors_first(bool first) { editors_first_ = first; }

  /// Whether somebody looks at all.
  bool any_visible() const;
  /// Whether one could be sent a frame in motion at once.
  bool any_ready() const;
  /// Whether all who look have the newest picture, whole and acknowledged.
  bool all_shown() const;
  /// Whether one could, and the newest picture is the one to send, but not encoded for it.
  bool any_lacking() const;
  /// Whether the newest picture is exact: encoded, or about to be.
  bool has_exact() const;

  /// A new picture: how it is to be encoded, for those who are ready; best rungs first.
  std::vector<EncodeOrder> show(const DrawnPicture& picture, Clock::time_point now);
  /// The same picture again, for those of any_lacking().
  std::vector<EncodeOrder> show_again(Clock::time_point now) const;
  /// It was encoded: to all who wait for it.
  void offer(const EncodedPtr& frame, Clock::time_point now);
  /// To one alone: the newest picture, if it is encoded for it.
  void offer_newest(const Client& client, Clock::time_point now);
  /// Sends what waits.
  [[nodiscard]] AckResult acknowledge(const Client& client, std::int64_t frame,
                                      Clock::time_point now);
  /// A picture could not be made.
  void forget_newest();

 private:
  Viewer* find_viewer(const Client& client);
  bool has_stream(const Viewer& viewer) const;
  EncodedPtr find_newest(const Viewer& viewer) const;
  /// The newest picture, losslessly; null when it is not exact, or not encoded.
  EncodedPtr find_lossless() const;
  bool wants_preview(const Viewer& viewer) const;
  std::vector<EncodeOrder> plan_previews() const;
  bool may_take(const Viewer& viewer, bool is_exact) const;
  bool is_lacking(const Viewer& viewer) const;
  void offer_newest(Viewer& viewer, Clock::time_point now);
  std::vector<EncodeOrder> plan(SharedStream::Kind kind, Clock::time_point now) const;
  std::optional<StreamFrame> plan_stream(std::size_t rung, SharedStream::Kind kind,
                                         Clock::time_point now) const;

  const int width_, height_;
  std::vector<Viewer> viewers_;
  std::int64_t joined_ = 0;  // so far
  Revision expected_;
  bool editors_first_ = false;
  std::optional<DrawnPicture> newest_;
  std::vector<EncodedPtr> encoded_;  // of the newest
  std::array<SharedStream, kVp8Rungs> streams_;
};

}  // namespace rimlight::server
