#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/light/environment.h"
#include "core/light/light_motion.h"

namespace rimlight {

/// The name that stands for whatever environment the caller gives.
inline constexpr std::string_view kGivenLight = "given";

// What a track shines with; environments by name, angles in radians.

struct EnvironmentSource {
  std::string light;
};
/// From one environment to another: (1 − p) from + p to, p eased.
struct BlendSource {
  std::string from, to;
  int frames = 2;
};
/// A soft disc that moves along a path and grows or shrinks, eased.
struct AreaLightSource {
  Vec3d radiance;
  SpherePath path;
  double radius_from = 0, radius_to = 0;
  double edge = 0;
  int frames = 2;
};
/// Soft discs that come one by one along a stroke and stay; where they overlap they add up. None at
/// frame 0, all at the last.
struct PaintSource {
  Vec3d radiance;
  SpherePath stroke;
  int spots = 1;
  double angular_radius = 0;
  double edge = 0;
  int frames = 2;
};
using LightSource = std::variant<EnvironmentSource, BlendSource, AreaLightSource, PaintSource>;

/// A source, turned and multiplied.
struct LightTrack {
  LightSource source;
  double scale = 1;
  std::optional<EasedTurn> rotate;
  std::optional<Flicker> flicker;
};

/// All that a track's light depends on in a frame: frames of equal poses have the same light.
struct TrackPose {
  Quaternion rotation;  // of environments and of a painting
  Vec3d direction;      // of an area light, turned
  double amount = 0;    // share of a blend; radius of an area light; spots painted, a whole number
  double factor = 1;    // scale times flicker

  friend bool operator==(const TrackPose&, const TrackPose&) = default;
};
TrackPose pose_at(const LightTrack& track, int frame);

/// Light in time: the sum of its tracks, frame by frame. Everything about a frame follows from its
/// number, so frames may be asked for in any order. Any thread.
struct LightSequence {
  std::string name;
  double frames_per_second = 60;
  int still_frames = 0;  // after the last motion has ended
  /// Environments that the sequence brings: names that tracks use, and .hdr or .exr files.
  std::map<std::string, std::filesystem::path> lights;
  std::vector<LightTrack> tracks;

  int frame_count() const;
  double seconds(int frame) const { return frame / frames_per_second; }
  /// Whether the sequence asks for another light than in the frame before; never in frame 0.
  bool is_moving(int frame) const;
  /// The environments that the tracks use, each once, sorted.
  std::vector<std::string> light_names() const;

  /// The environment of a sequence that shows one and does nothing but turn it, which is what edits
  /// of a session can play; nothing for any other sequence.
  std::optional<std::string> rotated_light() const;
  /// How that environment is turned; nothing for any other sequence.
  std::optional<Quaternion> rotation_at(int frame) const;
};

/// Environments by the names that a sequence uses.
using LightEnvironments = std::map<std::string, std::shared_ptr<const Environment>>;

/// Makes or loads the environments that a sequence uses; `given` stands for "given" and may be null
/// where that is not used. Throws Error naming the sequence or the file.
LightEnvironments load_environments(const LightSequence& sequence,
                                    const std::shared_ptr<const Environment>& given);

}  // namespace rimlight
