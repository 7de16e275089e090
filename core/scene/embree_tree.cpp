#include "core/scene/embree_tree.h"

#include <cstring>

#include "core/base/error.h"
#include "core/base/parallel.h"

namespace rimlight::embree {
namespace {

/// A buffer of Embree's own (which it pads as its SIMD loads need), filled from `values`.
template <typename T>
bool fill_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format,
                 std::span<const T> values) {
  void* const buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, sizeof(T), values.size());
  if (buffer != nullptr) std::memcpy(buffer, values.data(), values.size_bytes());
  return buffer != nullptr;
}

}  // namespace

DevicePtr new_device() {
  // Not "threads=1", which would hold the whole process to one thread as long as the device lives.
  DevicePtr device(rtcNewDevice("set_affinity=0"));
  if (!device) throw Error("Embree", "no device", "a CPU with SSE2");
  return device;
}

void check_device(RTCDevice device, const std::string& name) {
  const RTCError code = rtcGetDeviceError(device);
  if (code == RTC_ERROR_NONE) return;
  const std::string found = code == RTC_ERROR_OUT_OF_MEMORY
                                ? "no memory for its tree of rays"
                                : "Embree error " + std::to_string(static_cast<int>(code));
  throw Error(name, found, "a scene that Embree can take");
}

void attach_triangles(RTCDevice device, RTCScene scene, const Triangles& triangles, unsigned id) {
  if (triangles.corners.empty()) return;
  const GeometryPtr geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
  if (!geometry) return;
  static_assert(sizeof(Vec3f) == 12 && sizeof(triangles.corners[0]) == 12);
  if (!fill_buffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3,
                   triangles.positions) ||
      !fill_buffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, triangles.corners)) {
    return;  // the device holds the error
  }
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometryByID(scene, geometry.get(), id);
}

void commit_alone(RTCScene scene) {
  // Joining makes Embree work in our arena instead of its own.
  run_alone([scene] { rtcJoinCommitScene(scene); });
}

}  // namespace rimlight::embree
