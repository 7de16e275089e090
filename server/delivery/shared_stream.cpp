#include "server/delivery/shared_stream.h"

#include <algorithm>

namespace rimlight::server {
namespace {

constexpr std::int64_t kNone = KeptPictures::kNone;

}  // namespace

bool StreamFrame::can_follow(const KeptPictures& kept) const {
  if (links.is_key()) return true;
  return (!links.from_last || kept.last == from.last) &&
         (!links.from_golden || kept.golden == from.golden);
}

void StreamFrame::keep(KeptPictures& kept) const {
  if (links.is_key() || links.to_last) kept.last = number;
  if (links.is_key() || links.to_golden) kept.golden = number;
}

bool SharedStream::follows(const KeptPictures& kept) const {
  return (kept.last != kNone && kept.last == kept_.last) ||
         (kept.golden != kNone && kept.golden == kept_.golden);
}

StreamFrame SharedStream::frame_of(const Vp8Links& links) const {
  return {made_,
          links,
          {links.from_last ? kept_.last : kNone, links.from_golden ? kept_.golden : kNone}};
}

std::optional<StreamFrame> SharedStream::plan(std::span<const Member> members, Kind kind,
                                              Clock::time_point now) const {
  bool any_ready = false, any_starts = false, any_follows = false, all_can_take = true;
  Vp8Links links{.from_last = true, .from_golden = true};
  bool any_ready_follows = false;
  for (const Member& member : members) {
    const bool is_following = follows(member.kept);
    any_follows |= is_following;
    any_ready |= member.is_ready;
    if (!member.is_ready) {
      all_can_take &= member.can_owe;
      continue;
    }
    if (!is_following) {
      any_starts = true;
      continue;
    }
    any_ready_follows = true;
    links.from_last &= member.kept.last == kept_.last;
    links.from_golden &= member.kept.golden == kept_.golden;
  }
  if (!any_ready) return std::nullopt;
  // A key frame would start the others anew, too: for a repeated picture they would not get it.
  const bool is_due = !last_key_ || now - *last_key_ >= kKeyInterval;
  if (any_starts && (!any_follows || (kind == Kind::new_picture && is_due && all_can_take))) {
    return frame_of({});
  }
  if (!any_ready_follows) return std::nullopt;
  // Some have the last picture only, some the golden one: the latter are served, the others are
  // behind, and get a frame of their own next.
  if (links.is_key()) links.from_golden = true;
  if (kind == Kind::repeat) {
    links.to_last = false;
    return frame_of(links);
  }
  StreamFrame frame = frame_of(links);
  frame.links.to_golden =
      !links.from_last && std::all_of(members.begin(), members.end(), [&](const Member& member) {
        return !follows(member.kept) ||
               (frame.can_follow(member.kept) && (member.is_ready || member.can_owe));
      });
  return frame;
}

void SharedStream::made(const StreamFrame& frame, Clock::time_point now) {
  frame.keep(kept_);
  made_ = frame.number + 1;
  if (frame.links.is_key()) last_key_ = now;
}

}  // namespace rimlight::server
