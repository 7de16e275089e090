#include "core/curves/surface_light.h"

#include <algorithm>
#include <cstring>

#include "core/base/check.h"

namespace rimlight {
namespace {

using Block = SkyVisibilityView::Block;
constexpr std::size_t kBlockTexels = SkyVisibilityView::kBlockSide * SkyVisibilityView::kBlockSide;
constexpr std::size_t kVector = LightPoints::kVector;

/// Calls visit(block, kind, bytes of a mixed one) for each block of a surface.
template <typename Visit>
void for_each_block(const SkyVisibilityView& view, std::size_t surface, const Visit& visit) {
  const std::size_t count = view.blocks_per_surface();
  const Block* const kinds = view.blocks.data() + surface * count;
  const auto* mixed = view.mixed.data() + view.first_mixed[surface];
  for (std::size_t block = 0; block < count; ++block) {
    const bool is_mixed = kinds[block] == Block::mixed;
    visit(block, kinds[block], is_mixed ? mixed->data() : nullptr);
    mixed += is_mixed ? 1 : 0;
  }
}

std::uint8_t fifths_at(const std::uint8_t* mixed, std::size_t texel) {
  return static_cast<std::uint8_t>(mixed[texel / 2] >> 4 * (texel % 2) & 15);
}

/// Fifths of the four quarters of a mixed block, summed over 4 × 4 texels each.
std::array<float, 4> quarter_sums(const std::uint8_t* mixed) {
  std::array<float, 4> sums;
  for (std::size_t half = 0; half < 2; ++half) {
    std::uint32_t bytes = 0;  // each two columns of four rows: at most 40
    for (std::size_t row = 4 * half; row < 4 * half + 4; ++row) {
      std::uint32_t fifths = 0;  // a row: eight texels of four bits
      std::memcpy(&fifths, mixed + 4 * row, sizeof fifths);
      bytes += (fifths & 0x0f0f0f0fu) + (fifths >> 4 & 0x0f0f0f0fu);
    }
    sums[2 * half] = static_cast<float>((bytes & 255u) + (bytes >> 8 & 255u));
    sums[2 * half + 1] = static_cast<float>((bytes >> 16 & 255u) + (bytes >> 24));
  }
  return sums;
}

bool may_face(const LightPoints::Cone& cone, const Vec3f& normal) {
  return cone.x * normal.x + cone.y * normal.y + cone.z * normal.z > -cone.sine;
}

}  // namespace

PreparedSurface prepare(const CurveSurface& surface, const CurveMaterialState& state,
                        const LobeTables& tables) {
  PreparedSurface result;
  for (std::size_t q = 0; q < kSurfacePoints; ++q) {
    const SurfacePoint& point = surface.points[q];
    const Frame<float> frame(point.normal, point.tangent);
    const Vec3f outgoing = frame.to_local(point.outgoing);
    result.faces_viewer[q] = outgoing.z > 0;
    if (!result.faces_viewer[q]) continue;
    result.points[q] = {frame.tangent,          frame.bitangent, frame.normal,
                        point.geometric_normal, outgoing,        {1, 1, 1}};
    if (state.measured) {
      result.points[q].rest_out = tables.rest(outgoing.z);
    }
    const DiffuseFactors factors = diffuse_factors(state, tables, outgoing.z);
    result.diffuse[q] = {factors.plain * surface.tint, factors.sloped * surface.tint};
  }
  return result;
}

void SurfaceSight::begin(const LightPoints& points, const PointRadiance& radiance) {
  points_ = &points;
  radiance_ = &radiance;
  visibility_.resize(points.size());
  seen_.clear();
}

void SurfaceSight::add_vector(std::size_t vector) {
  if (radiance_->lit_vector[vector] != 0) seen_.push_back(static_cast<std::uint32_t>(vector));
}

void SurfaceSight::look_at_texels(const SkyVisibilityView& view, std::size_t surface, float share,
                                  const CurveLight& light) {
  begin(light.sky().texels(), light.texels());
  const float step = share / SkyVisibilityView::kAll;
  for_each_block(view, surface, [&](std::size_t block, Block kind, const std::uint8_t* mixed) {
    if (kind == Block::none) return;
    float* const to = visibility_.data() + block * kBlockTexels;
    if (kind == Block::all) {
      std::fill_n(to, kBlockTexels, share);
    } else {
      for (std::size_t i = 0; i < kBlockTexels; ++i) {
        to[i] = step * static_cast<float>(fifths_at(mixed, i));
      }
    }
    for (std::size_t i = 0; i < kBlockTexels / kVector; ++i) {
      add_vector(block * (kBlockTexels / kVector) + i);
    }
  });
}

void SurfaceSight::look_at_means(const SkyVisibilityView& view, std::size_t surface, float share,
                                 const CurveLight& light) {
  begin(light.sky().coarse(), light.coarse());
  const float step = share / (SkyVisibilityView::kAll * 16);
  for_each_block(view, surface, [&](std::size_t block, Block kind, const std::uint8_t* mixed) {
    float* const to = visibility_.data() + 4 * block;
    if (kind != Block::mixed) {
      std::fill_n(to, 4, kind == Block::all ? share : 0.0f);
    } else {
      const auto sums = quarter_sums(mixed);
      for (std::size_t i = 0; i < 4; ++i) to[i] = step * sums[i];
    }
  });
  std::fill(visibility_.begin() + static_cast<std::ptrdiff_t>(4 * view.blocks_per_surface()),
            visibility_.end(), 0.0f);
  for (std::size_t i = 0; i < visibility_.size() / kVector; ++i) add_vector(i);
}

void SurfaceSight::look_at_strongest(const SkyVisibilityView& view, std::size_t surface,
                                     float share, const CurveLight& light) {
  begin(light.strongest_points(), light.strongest());
  const float step = share / SkyVisibilityView::kAll;
  const auto strongest = light.strongest_indices();
  std::size_t i = 0;
  for_each_block(view, surface, [&](std::size_t block, Block kind, const std::uint8_t* mixed) {
    for (; i < strongest.size() && strongest[i] / kBlockTexels == block; ++i) {
      const std::size_t texel = strongest[i] % kBlockTexels;
      visibility_[i] = kind == Block::none  ? 0.0f
                       : kind == Block::all ? share
                                            : step * static_cast<float>(fifths_at(mixed, texel));
    }
  });
  std::fill(visibility_.begin() + static_cast<std::ptrdiff_t>(i), visibility_.end(), 0.0f);
  for (std::size_t v = 0; v < visibility_.size() / kVector; ++v) add_vector(v);
}

LitQuarter SurfaceSight::quarter(std::size_t quarter, const SurfacePoint& point) {
  facing_.clear();
  for (const std::uint32_t vector : seen_) {
    const LightPoints::Cone& cone = points_->cones[vector];
    if (may_face(cone, point.normal) && may_face(cone, point.geometric_normal)) {
      facing_.push_back(vector);
    }
  }
  return {&points_->quarters[quarter], radiance_, visibility_.data(), facing_};
}

Vec3f radiance_of(const LobeSums& sums, const DiffuseFactors& diffuse) {
  return sums.plain * diffuse.plain + sums.sloped * diffuse.sloped + sums.lobe;
}

Vec3f sum_row(const CurveReceivers& receivers, const CurvePanel& panel, std::size_t row,
              const CurveLight& light, const CurveMaterialState& state, const LobeTables& tables,
              float* bins) {
  thread_local SurfaceSight sight;
  Vec3f radiance;
  for (auto i = panel.first_surface[row]; i < panel.first_surface[row + 1]; ++i) {
    const CurveSurface& surface = receivers.surfaces[i];
    const PreparedSurface prepared = prepare(surface, state, tables);
    sight.look_at_texels(receivers.visibility, i, surface.share, light);
    for (std::size_t q = 0; q < kSurfacePoints; ++q) {
      if (!prepared.faces_viewer[q]) continue;
      const LitQuarter lit = sight.quarter(q, surface.points[q]);
      LobeSums sums;
      if (bins) {
        add_bins(tables, prepared.points[q], lit, sums,
                 std::span<float, kBinFloats>(bins, kBinFloats));
      } else {
        add_shading(tables, prepared.points[q], lit, sums);
      }
      radiance += radiance_of(sums, prepared.diffuse[q]);
    }
  }
  return radiance;
}

}  // namespace rimlight
