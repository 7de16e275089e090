#pragma once

#include <cstdint>
#include <filesystem>

#include "core/bake/group_source.h"
#include "core/basis/cube_haar.h"
#include "core/transport/bake_folder.h"

namespace rimlight::test {

/// Transport in closed form: a ball under distant light that nothing shadows, half matte and half
/// glossy, seen head on; a pixel's rows depend on its normal alone. No rays. With `noise` each
/// number is that much off, relative, in the root of the mean of squares.
class BallSource final : public GroupSource {
 public:
  BallSource(int side, int cube_size, double noise = 0, std::uint64_t seed = 0);

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
  double noise_;
  std::uint64_t seed_;
};

/// A bake of it under "sunny" and "studio", with the reference rows of so many receivers (0: none),
/// and of some of them what the other sources make.
void bake_ball(const std::filesystem::path& folder, const BallSource& source,
               std::size_t reference_receivers, const BallSource* retraced = nullptr,
               const BallSource* finer = nullptr);

}  // namespace rimlight::test
