#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/bake/check_lights.h"
#include "core/bake/direct_transport.h"
#include "core/bake/group.h"
#include "core/bake/indirect_transport.h"
#include "core/basis/cube_haar.h"

namespace rimlight {

/// One group, baked and projected, before anything is left out.
struct BakedGroup {
  bool empty = true;                  // no geometry in sight: rows are not valid
  GroupRows coefficients;             // Haar, [coefficient][3][64]
  AlignedVector<float> check_images;  // [check light][3][64], of the whole transport
  std::array<float, kGroupLanes> coverage{};

  BakedGroup(int cube_size, std::size_t check_lights)
      : coefficients(cube_size), check_images(check_lights * kRowLanes), texels_(cube_size) {}

 private:
  friend class GroupBaker;
  GroupRows texels_;  // scratch
  GroupSamples samples_;
};

/// Bakes groups of 8×8 pixels: primary rays, direct and indirect transport, projection. A group's
/// result depends on the scene, its settings and its place alone: any thread, any order.
class GroupBaker {
 public:
  GroupBaker(const RayScene& scene, const std::vector<CheckLight>& check_lights);

  const PixelLayout& layout() const { return layout_; }
  const CubeHaar& haar() const { return haar_; }

  void bake(std::size_t first_receiver, BakedGroup& group) const;

  /// Whether any primary ray of the group hits something.
  bool sees_geometry(std::size_t first_receiver) const;
  const std::vector<CubeLight>& check_lights() const { return check_lights_; }

 private:
  const RayScene& scene_;
  PixelLayout layout_;
  CubeHaar haar_;
  DirectTransport direct_;
  IndirectTransport indirect_;
  std::vector<CubeLight> check_lights_;
};

}  // namespace rimlight
