#pragma once

#include <filesystem>

#include "core/bake/group_source.h"
#include "core/basis/cube_haar.h"
#include "core/transport/bake_folder.h"

namespace rimlight::test {

/// Transport in closed form: a ball under distant light that nothing shadows, half matte and half
/// glossy, seen head on; a pixel's rows depend on its normal alone. No rays.
class BallSource final : public GroupSource {
 public:
  BallSource(int side, int cube_size);

  const PixelLayout& layout() const override { return layout_; }
  int cube_size() const override { return haar_.size(); }
  float typical_size() const override {
    return 1 / static_cast<float>(haar_.size() * haar_.size());
  }
  void find_rows(std::size_t first_receiver, BakedGroup& group) const override;
  bool has_receivers(std::size_t first_receiver) const override;

 private:
  PixelLayout layout_;
  CubeHaar haar_;
};

/// A bake of it under "sunny" and "studio", with the reference rows of so many receivers (0: none).
void bake_ball(const std::filesystem::path& folder, const BallSource& source,
               std::size_t reference_receivers);

}  // namespace rimlight::test
