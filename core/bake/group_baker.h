#pragma once

#include "core/bake/direct_transport.h"
#include "core/bake/group_source.h"
#include "core/bake/indirect_transport.h"
#include "core/basis/cube_haar.h"

namespace rimlight {

/// Bakes groups of 8×8 pixels of a scene: primary rays, direct and indirect transport, projection.
class GroupBaker final : public GroupSource {
 public:
  /// Keeps the scene, and bakes it as its own settings say, or as others do. Light that comes
  /// straight from the environment is that of surfaces of `direct` alone.
  explicit GroupBaker(const RayScene& scene) : GroupBaker(scene, scene.scene().bake) {}
  GroupBaker(const RayScene& scene, const BakeSettings& settings, const MaterialSet& direct = {});

  const PixelLayout& layout() const override { return layout_; }
  int cube_size() const override { return haar_.size(); }
  /// A texel's share of the sphere.
  float typical_size() const override {
    return 1 / static_cast<float>(haar_.size() * haar_.size());
  }
  void find_rows(std::size_t first_receiver, BakedGroup& group) const override;
  /// Whether any primary ray of the group hits something.
  bool has_receivers(std::size_t first_receiver) const override;

 private:
  const RayScene& scene_;
  BakeSettings settings_;
  PixelLayout layout_;
  CubeHaar haar_;
  DirectTransport direct_;
  IndirectTransport indirect_;
};

}  // namespace rimlight
