#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>

#include "core/math/vec.h"

/// What this folder's users of Embree share: owners of its objects, errors, trees that are the same
/// at every build.
namespace rimlight::embree {

struct Release {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using DevicePtr = std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release>;
using ScenePtr = std::unique_ptr<std::remove_pointer_t<RTCScene>, Release>;
using GeometryPtr = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, Release>;

/// Throws Error when Embree does not know the processor.
DevicePtr new_device();

/// Throws Error, naming `name`, when something failed on the device since the last check (memory).
void check_device(RTCDevice device, const std::string& name);

struct Triangles {
  std::span<const Vec3f> positions;
  std::span<const std::array<std::uint32_t, 3>> corners;  // indices of positions
};

/// Adds triangles under an id, copied; none leave the id unused. The device holds the error if any.
void attach_triangles(RTCDevice device, RTCScene scene, const Triangles& triangles, unsigned id);

/// Builds the tree on this thread alone: Embree's parallel builders split by work stealing, which
/// may change the tree.
void commit_alone(RTCScene scene);

}  // namespace rimlight::embree
