#include "core/scene/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/scene/embree_tree.h"
#include "core/scene/texture.h"

namespace rimlight {
namespace {

/// Rays of one stream: enough to fill Embree's queues, few enough to stay in L2.
constexpr std::size_t kStreamSize = 512;
constexpr std::size_t kPacketSize = 16;
static_assert(SkyRays::kSlack >= kPacketSize && SkyRays::kCapacity % kPacketSize == 0);
/// A hit's position is off by a few 2^-24 of the triangle's coordinates, and so is Embree's own
/// arithmetic on a neighbour's plane: 2^-16 of them clears both by far.
constexpr float kOffsetScale = 0x1p-16f;
/// The least cosine between a shading normal and the ray that it faces.
constexpr float kLeastCosine = 0.01f;

/// Geometry ids are mesh indices; a mesh without triangles leaves its id unused.
void attach(RTCDevice device, RTCScene scene, const Mesh& mesh, unsigned id) {
  embree::attach_triangles(device, scene, {mesh.positions, mesh.triangles}, id);
}

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// What is the same for every ray.
RTCRay blank_ray() {
  RTCRay result{};
  result.tnear = 0;
  result.mask = 0xffffffffu;
  return result;
}

/// The rest of a blank ray. (Embree changes nothing but the end of a ray that it tests.)
void set_ray(const Ray& ray, float far, RTCRay& result) {
  result.org_x = ray.origin.x;
  result.org_y = ray.origin.y;
  result.org_z = ray.origin.z;
  result.dir_x = ray.direction.x;
  result.dir_y = ray.direction.y;
  result.dir_z = ray.direction.z;
  result.tfar = far;
}

/// Embree sets an occluded ray's end to minus infinity.
std::uint8_t escaped(float end) { return end == -kInfinity ? 0 : 1; }

RTCIntersectContext context_for(Coherence coherence) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = coherence == Coherence::high ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                               : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

/// What is the same for every packet of rays to the sky.
RTCRay16 blank_packet() {
  RTCRay16 packet{};
  std::fill_n(packet.mask, kPacketSize, 0xffffffffu);
  return packet;
}

/// The rest of a blank packet: rays from `begin` on. Those from `end` on are never traced.
void set_packet(const SkyRays& rays, std::size_t begin, std::size_t end, RTCRay16& packet) {
  const auto copy = [begin](const SkyRays::Component& from, float* to) {
    std::copy_n(from.data() + begin, kPacketSize, to);
  };
  copy(rays.origin[0], packet.org_x);
  copy(rays.origin[1], packet.org_y);
  copy(rays.origin[2], packet.org_z);
  copy(rays.direction[0], packet.dir_x);
  copy(rays.direction[1], packet.dir_y);
  copy(rays.direction[2], packet.dir_z);
  for (std::size_t i = 0; i < kPacketSize; ++i) {
    packet.tfar[i] = begin + i < end ? kInfinity : -kInfinity;
  }
}

void trace_packets(RTCScene tree, const SkyRays& rays, std::span<std::uint8_t> visible) {
  alignas(64) std::array<int, kPacketSize> all;
  all.fill(-1);
  RTCRay16 packet = blank_packet();
  RTCIntersectContext context = context_for(Coherence::high);
  for (std::size_t begin = 0; begin < rays.count; begin += kPacketSize) {
    set_packet(rays, begin, rays.count, packet);
    rtcOccluded16(all.data(), tree, &context, &packet);
    const std::size_t count = std::min(kPacketSize, rays.count - begin);
    for (std::size_t i = 0; i < count; ++i) visible[begin + i] = escaped(packet.tfar[i]);
  }
}

RTCRayHit first_hit(RTCScene tree, const Ray& ray) {
  RTCRayHit query{};
  query.ray = blank_ray();
  set_ray(ray, kInfinity, query.ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(tree, &context, &query);
  return query;
}

float largest_component(const Vec3f& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Weights of a triangle's corners.
struct Barycentric {
  float w0, w1, w2;

  template <typename T>
  auto mix(const T& a, const T& b, const T& c) const {
    return a * w0 + b * w1 + c * w2;
  }
};

/// The interpolated normal on the side of `geometric`, bent until it faces `to_ray`.
Vec3f shading_normal(const Mesh& mesh, const std::array<std::uint32_t, 3>& corner,
                     const Barycentric& at, const Vec3f& geometric, const Vec3f& to_ray) {
  if (mesh.normals.empty()) return geometric;
  Vec3f normal = at.mix(mesh.normals[corner[0]], mesh.normals[corner[1]], mesh.normals[corner[2]]);
  const float squared = dot(normal, normal);
  if (!(squared > 1e-12f)) return geometric;
  normal = normal / std::sqrt(squared);
  // Not by the sign of a single dot product: a smooth normal may lean over the edge of its
  // triangle.
  if (dot(normal, geometric) < 0) normal = -normal;
  const float cosine = dot(normal, to_ray);
  if (cosine >= kLeastCosine) return normal;
  // Both the normal and to_ray are on the geometric side, and so is their sum.
  const Vec3f bent = normal + to_ray * (kLeastCosine - cosine);
  return dot(bent, bent) > 1e-12f ? normalized(bent) : geometric;
}

Brdf brdf_at(const Material& material, const Mesh& mesh, const std::array<std::uint32_t, 3>& corner,
             const Barycentric& at) {
  Brdf brdf = material.brdf;
  if (!material.albedo_texture || mesh.texture_coordinates.empty()) return brdf;
  const auto& a = mesh.texture_coordinates[corner[0]];
  const auto& b = mesh.texture_coordinates[corner[1]];
  const auto& c = mesh.texture_coordinates[corner[2]];
  brdf.albedo *=
      texture_at(*material.albedo_texture, {at.mix(a.u, b.u, c.u), at.mix(a.v, b.v, c.v)});
  return brdf;
}

}  // namespace

struct RayScene::State {
  std::shared_ptr<const Scene> source;
  embree::DevicePtr device;
  embree::ScenePtr tree;
  float extent = 0;
  bool has_packets = false;
};

RayScene::RayScene(std::shared_ptr<const Scene> scene) : state_(std::make_unique<State>()) {
  RIMLIGHT_CHECK(scene != nullptr);
  flush_denormals();
  state_->source = std::move(scene);
  state_->device = embree::new_device();
  RTCDevice const device = state_->device.get();
  state_->tree.reset(rtcNewScene(device));
  RTCScene const tree = state_->tree.get();
  embree::check_device(device, state_->source->name);
  state_->has_packets =
      rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0;
  rtcSetSceneBuildQuality(tree, RTC_BUILD_QUALITY_HIGH);
  // RTC_SCENE_FLAG_ROBUST would close the gaps along shared edges, of a rounding error's width:
  // none of 2 million random rays in a closed shell finds one, and it halves the speed.
  for (std::size_t i = 0; i < state_->source->meshes.size(); ++i) {
    attach(device, tree, state_->source->meshes[i], static_cast<unsigned>(i));
  }
  embree::check_device(device, state_->source->name);
  embree::commit_alone(tree);
  embree::check_device(device, state_->source->name);
  RTCBounds bounds{};
  rtcGetSceneBounds(tree, &bounds);
  const float longest = std::max({bounds.upper_x - bounds.lower_x, bounds.upper_y - bounds.lower_y,
                                  bounds.upper_z - bounds.lower_z});
  state_->extent = longest > 0 ? longest : 0;  // an empty scene's bounds are inside out
}

RayScene::~RayScene() = default;

const Scene& RayScene::scene() const { return *state_->source; }

float RayScene::extent() const { return state_->extent; }

std::optional<TriangleHit> RayScene::find_triangle(const Ray& ray) const {
  const RTCRayHit query = first_hit(state_->tree.get(), ray);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return TriangleHit{query.hit.geomID, query.hit.primID, query.hit.u, query.hit.v};
}

std::optional<SurfaceHit> RayScene::intersect(const Ray& ray) const {
  const RTCRayHit query = first_hit(state_->tree.get(), ray);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  const Mesh& mesh = state_->source->meshes[query.hit.geomID];
  const auto& corner = mesh.triangles[query.hit.primID];
  const Vec3f& a = mesh.positions[corner[0]];
  const Vec3f& b = mesh.positions[corner[1]];
  const Vec3f& c = mesh.positions[corner[2]];
  const Barycentric at{1 - query.hit.u - query.hit.v, query.hit.u, query.hit.v};
  SurfaceHit hit;
  // From the corners, not along the ray: the error does not grow with the distance.
  hit.position = at.mix(a, b, c);
  hit.distance = query.ray.tfar;
  // In double: a sliver's cross product in floats may point anywhere.
  const Vec3d corner_a(a);
  hit.geometric_normal = Vec3f(normalized(cross(Vec3d(b) - corner_a, Vec3d(c) - corner_a)));
  if (dot(hit.geometric_normal, ray.direction) > 0) hit.geometric_normal = -hit.geometric_normal;
  hit.shading_normal = shading_normal(mesh, corner, at, hit.geometric_normal, -ray.direction);
  const Material& material = state_->source->materials[mesh.material];
  hit.material = mesh.material;
  hit.brdf = brdf_at(material, mesh, corner, at);
  if (is_anisotropic(hit.brdf)) hit.tangent = material.tangent;
  hit.offset =
      kOffsetScale * std::max({largest_component(a), largest_component(b), largest_component(c)});
  return hit;
}

void RayScene::visible(std::span<const Ray> rays, std::span<const float> far,
                       std::span<std::uint8_t> visible) const {
  RIMLIGHT_CHECK_EQ(visible.size(), rays.size());
  RIMLIGHT_CHECK(far.empty() || far.size() == rays.size());
  alignas(64) thread_local std::array<RTCRay, kStreamSize> stream = [] {
    std::array<RTCRay, kStreamSize> blank{};
    blank.fill(blank_ray());
    return blank;
  }();
  flush_denormals();
  RTCIntersectContext context = context_for(Coherence::low);
  for (std::size_t begin = 0; begin < rays.size(); begin += kStreamSize) {
    const std::size_t count = std::min(kStreamSize, rays.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      set_ray(rays[begin + i], far.empty() ? kInfinity : far[begin + i], stream[i]);
    }
    rtcOccluded1M(state_->tree.get(), &context, stream.data(), static_cast<unsigned>(count),
                  sizeof(RTCRay));
    for (std::size_t i = 0; i < count; ++i) visible[begin + i] = escaped(stream[i].tfar);
  }
}

void RayScene::visible(SkyRays& rays, Coherence coherence, std::span<std::uint8_t> visible) const {
  RIMLIGHT_CHECK(rays.count <= SkyRays::kCapacity && rays.count <= visible.size());
  flush_denormals();
  if (coherence == Coherence::high && state_->has_packets) {
    trace_packets(state_->tree.get(), rays, visible);
    return;
  }
  RTCIntersectContext context = context_for(Coherence::low);
  std::fill_n(rays.end.begin(), rays.count, kInfinity);
  const RTCRayNp stream = {
      rays.origin[0].data(),    rays.origin[1].data(),    rays.origin[2].data(),
      rays.zero.data(),         rays.direction[0].data(), rays.direction[1].data(),
      rays.direction[2].data(), rays.zero.data(),         rays.end.data(),
      rays.all_bits.data(),     rays.no_bits.data(),      rays.no_bits.data()};
  rtcOccludedNp(state_->tree.get(), &context, &stream, static_cast<unsigned>(rays.count));
  for (std::size_t i = 0; i < rays.count; ++i) visible[i] = escaped(rays.end[i]);
}

Vec3f RayScene::ray_origin(const SurfaceHit& hit, const Vec3f& direction) {
  const float side = dot(hit.geometric_normal, direction) < 0 ? -hit.offset : hit.offset;
  return hit.position + hit.geometric_normal * side;
}

}  // namespace rimlight
