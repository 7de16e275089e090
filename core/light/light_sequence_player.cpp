#include "core/light/light_sequence_player.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/light/light_rotation.h"
#include "core/light/soft_disc.h"

namespace rimlight {
namespace {

constexpr float kBrightest = 1e30f;

using ProjectedLights = std::map<std::string, CubeLight>;

/// Every environment that the sequence uses, once.
ProjectedLights project_lights(const LightSequence& sequence, int size,
                               const LightEnvironments& environments) {
  ProjectedLights lights;
  for (const std::string& name : sequence.light_names()) {
    const auto found = environments.find(name);
    RIMLIGHT_CHECK(found != environments.end());
    const CubeLight& light = lights[name] = found->second->project(size);
    const float brightest = *std::max_element(light.values.begin(), light.values.end());
    if (!(brightest <= kBrightest)) {
      throw Error("environment " + quote(name), "the radiance " + std::to_string(brightest),
                  "at most 1e30");
    }
  }
  return lights;
}

void add_spot(const PaintSource& paint, int spot, const Quaternion& rotation, CubeLight& light) {
  const double share = paint.spots > 1 ? static_cast<double>(spot) / (paint.spots - 1) : 0;
  const Vec3d direction = normalized(rotated(rotation, paint.stroke.at(share)));
  add_disc({direction, paint.angular_radius, paint.edge}, paint.radiance, light);
}

}  // namespace

/// One track's light before its factor: kept from frame to frame, made anew where its pose changes.
class LightSequencePlayer::TrackLight {
 public:
  TrackLight(const LightTrack& track, int size, const ProjectedLights& lights)
      : track_(track), light_(size), second_(0) {
    if (const auto* const one = std::get_if<EnvironmentSource>(&track.source)) {
      rotators_.emplace_back(lights.at(one->light));
    } else if (const auto* const blend = std::get_if<BlendSource>(&track.source)) {
      rotators_.emplace_back(lights.at(blend->from));
      rotators_.emplace_back(lights.at(blend->to));
      second_ = CubeLight(size);
    }
  }

  void add_frame(int frame, CubeLight& sum) {
    TrackPose pose = pose_at(track_, frame);
    const auto factor = static_cast<float>(std::exchange(pose.factor, 1));
    if (held_ != pose) {
      std::visit([&](const auto& source) { show(source, pose); }, track_.source);
      held_ = pose;
    }
    for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += factor * light_.values[i];
  }

 private:
  void show(const EnvironmentSource&, const TrackPose& pose) {
    rotators_[0].rotate(pose.rotation, light_);
  }

  void show(const BlendSource&, const TrackPose& pose) {
    rotators_[0].rotate(pose.rotation, light_);
    rotators_[1].rotate(pose.rotation, second_);
    const auto to = static_cast<float>(pose.amount), from = static_cast<float>(1 - pose.amount);
    for (std::size_t i = 0; i < light_.values.size(); ++i) {
      light_.values[i] = from * light_.values[i] + to * second_.values[i];
    }
  }

  void show(const AreaLightSource& source, const TrackPose& pose) {
    std::fill(light_.values.begin(), light_.values.end(), 0.0f);
    add_disc({pose.direction, pose.amount, source.edge}, source.radiance, light_);
  }

  /// Goes on from the spots that are there where it can: the sums are those of starting anew.
  void show(const PaintSource& source, const TrackPose& pose) {
    int spot = 0;
    if (held_ && held_->rotation == pose.rotation && held_->amount <= pose.amount) {
      spot = static_cast<int>(held_->amount);
    } else {
      std::fill(light_.values.begin(), light_.values.end(), 0.0f);
    }
    for (; spot < static_cast<int>(pose.amount); ++spot) {
      add_spot(source, spot, pose.rotation, light_);
    }
  }

  LightTrack track_;
  CubeLight light_;
  std::optional<TrackPose> held_;  // of light_, with factor 1
  std::vector<LightRotator> rotators_;
  CubeLight second_;  // a blend's other end
};

LightSequencePlayer::LightSequencePlayer(LightSequence sequence, int size,
                                         const LightEnvironments& environments)
    : sequence_(std::move(sequence)) {
  RIMLIGHT_CHECK(size >= 2 && size <= cube::kLargestSize);
  frame_.light = CubeLight(size);
  const ProjectedLights lights = project_lights(sequence_, size, environments);
  for (const LightTrack& track : sequence_.tracks) {
    tracks_.push_back(std::make_unique<TrackLight>(track, size, lights));
  }
}

LightSequencePlayer::LightSequencePlayer(LightSequencePlayer&& other) noexcept = default;
LightSequencePlayer& LightSequencePlayer::operator=(LightSequencePlayer&& other) noexcept = default;
LightSequencePlayer::~LightSequencePlayer() = default;

const LightFrame& LightSequencePlayer::at(int frame) {
  RIMLIGHT_CHECK(frame >= 0 && frame < sequence_.frame_count());
  frame_.index = frame;
  frame_.seconds = sequence_.seconds(frame);
  frame_.moving = sequence_.is_moving(frame);
  std::fill(frame_.light.values.begin(), frame_.light.values.end(), 0.0f);
  for (const auto& track : tracks_) track->add_frame(frame, frame_.light);
  return frame_;
}

}  // namespace rimlight
