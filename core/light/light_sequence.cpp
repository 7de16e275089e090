#include "core/light/light_sequence.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <type_traits>
#include <utility>

#include "core/base/error.h"

namespace rimlight {
namespace {

/// Frames that a source takes to come to rest.
int frames_of(const LightSource& source) {
  return std::visit(
      [](const auto& one) {
        if constexpr (std::is_same_v<std::decay_t<decltype(one)>, EnvironmentSource>) {
          return 1;
        } else {
          return one.frames;
        }
      },
      source);
}

int frames_of(const LightTrack& track) {
  int frames = frames_of(track.source);
  if (track.rotate) frames = std::max(frames, track.rotate->frames);
  if (track.flicker) frames = std::max(frames, track.flicker->frames());
  return frames;
}

// What the kind of source makes of a pose that is turned and multiplied already.

void set_source(const EnvironmentSource&, int, TrackPose&) {}

void set_source(const BlendSource& blend, int frame, TrackPose& pose) {
  pose.amount = eased_share(frame, blend.frames);
}

void set_source(const AreaLightSource& light, int frame, TrackPose& pose) {
  const double share = eased_share(frame, light.frames);
  pose.direction = normalized(rotated(pose.rotation, light.path.at(share)));
  pose.rotation = {};  // nothing else of a disc turns
  pose.amount = std::lerp(light.radius_from, light.radius_to, share);
}

void set_source(const PaintSource& paint, int frame, TrackPose& pose) {
  const int last = paint.frames - 1;
  const std::int64_t spots = std::int64_t{std::min(frame, last)} * paint.spots / last;
  pose.amount = static_cast<double>(spots);
  if (pose.amount == 0) pose.rotation = {};
}

}  // namespace

TrackPose pose_at(const LightTrack& track, int frame) {
  TrackPose pose;
  if (track.rotate) pose.rotation = track.rotate->rotation(frame);
  pose.factor = track.scale * (track.flicker ? track.flicker->factor(frame) : 1);
  std::visit([&](const auto& source) { set_source(source, frame, pose); }, track.source);
  return pose;
}

int LightSequence::frame_count() const {
  int moving = 1;
  for (const LightTrack& track : tracks) moving = std::max(moving, frames_of(track));
  return moving + still_frames;
}

bool LightSequence::is_moving(int frame) const {
  if (frame <= 0) return false;
  return std::any_of(tracks.begin(), tracks.end(), [frame](const LightTrack& track) {
    return !(pose_at(track, frame) == pose_at(track, frame - 1));
  });
}

std::vector<std::string> LightSequence::light_names() const {
  std::set<std::string> names;
  for (const LightTrack& track : tracks) {
    if (const auto* const environment = std::get_if<EnvironmentSource>(&track.source)) {
      names.insert(environment->light);
    } else if (const auto* const blend = std::get_if<BlendSource>(&track.source)) {
      names.insert({blend->from, blend->to});
    }
  }
  return {names.begin(), names.end()};
}

std::optional<std::string> LightSequence::rotated_light() const {
  if (tracks.size() != 1) return std::nullopt;
  const LightTrack& track = tracks.front();
  const auto* const environment = std::get_if<EnvironmentSource>(&track.source);
  if (environment == nullptr || track.flicker || track.scale != 1) return std::nullopt;
  return environment->light;
}

std::optional<Quaternion> LightSequence::rotation_at(int frame) const {
  if (!rotated_light()) return std::nullopt;
  return pose_at(tracks.front(), frame).rotation;
}

LightEnvironments load_environments(const LightSequence& sequence,
                                    const std::shared_ptr<const Environment>& given) {
  LightEnvironments environments;
  for (const std::string& name : sequence.light_names()) {
    if (name == kGivenLight) {
      if (!given) throw Error(sequence.name, "no light for " + quote(name), "an environment");
      environments[name] = given;
    } else if (const auto file = sequence.lights.find(name); file != sequence.lights.end()) {
      environments[name] = std::make_shared<const Environment>(load_environment(file->second));
    } else {
      environments[name] = std::make_shared<const Environment>(builtin_environment(name));
    }
  }
  return environments;
}

}  // namespace rimlight
