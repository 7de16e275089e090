#include "core/vertices/view_weights.h"

#include <algorithm>
#include <array>

#include "core/base/parallel.h"

namespace rimlight {
namespace {

constexpr int kSparse = 4;
constexpr int kSmallPicture = 128 * 128;
/// Rows of one piece of parallel work.
constexpr int kRows = 64;

/// The corners of a pixel's points, each vertex once.
class PixelCorners {
 public:
  static constexpr std::size_t kMost = 64;

  void add(std::uint32_t vertex, double weight, bool shines) {
    std::size_t i = 0;
    while (i < count_ && corners_[i].vertex != vertex) ++i;
    if (i == kMost) return;
    if (i == count_) corners_[count_++] = {vertex, 0, 0};
    corners_[i].weight += weight;
    corners_[i].shining += shines ? weight : 0;
  }

  void add_squares(const VertexMesh& mesh, std::size_t highlight_count,
                   std::span<const float> sampling, double scale, MaterialWeights* sums) const {
    if (count_ == 0) return;
    Vec3d all;
    double shining = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const Corner& corner = corners_[i];
      const Vec3d value = Vec3d(mesh.tints[corner.vertex]) * corner.weight;
      const double by_chance = scale * static_cast<double>(sampling[corner.vertex]);
      MaterialWeights& to = sums[mesh.materials[corner.vertex]];
      (corner.vertex < highlight_count ? to.glossy_by_chance : to.matt_by_chance) +=
          value * value * by_chance;
      to.highlight_by_chance += corner.shining * corner.shining * by_chance;
      all += value;
      shining += corner.shining;
    }
    MaterialWeights& first = sums[mesh.materials[corners_[0].vertex]];
    first.shared += all * all * scale;
    first.highlight_shared += shining * shining * scale;
  }

 private:
  struct Corner {
    std::uint32_t vertex = 0;
    double weight = 0, shining = 0;
  };
  std::array<Corner, kMost> corners_;
  std::size_t count_ = 0;
};

PixelCorners corners_of(const VertexView& view, const VertexMesh& mesh, int x, int y) {
  PixelCorners corners;
  const double share = 1.0 / static_cast<double>(view.layer_count());
  for (std::size_t layer = 0; layer < view.layer_count(); ++layer) {
    const PrimaryHit& hit = view.hit(layer, x, y);
    if (hit.is_miss()) continue;
    const auto& vertices = mesh.triangles[hit.triangle];
    const std::array<double, 3> weights = {1.0 - hit.u - hit.v, hit.u, hit.v};
    const bool shines = view.has_highlight(layer, x, y);
    for (std::size_t k = 0; k < 3; ++k) corners.add(vertices[k], weights[k] * share, shines);
  }
  return corners;
}

}  // namespace

MaterialWeights& MaterialWeights::operator+=(const MaterialWeights& other) {
  matt_by_chance += other.matt_by_chance;
  glossy_by_chance += other.glossy_by_chance;
  shared += other.shared;
  highlight_by_chance += other.highlight_by_chance;
  highlight_shared += other.highlight_shared;
  return *this;
}

void ViewWeights::find(const VertexView& view, const VertexMesh& mesh, std::size_t highlight_count,
                       std::span<const float> sampling) {
  const bool is_small = view.width() * view.height() <= kSmallPicture;
  const int stride = is_small ? view.step() : kSparse;
  const std::size_t pieces = static_cast<std::size_t>((view.height() + kRows - 1) / kRows);
  rows_.assign(pieces * sums_.size(), {});
  parallel_for(pieces, [&](std::size_t piece) {
    const int first = static_cast<int>(piece) * kRows;
    for (int y = first; y < std::min(first + kRows, view.height()); y += stride) {
      for (int x = 0; x < view.width(); x += stride) {
        corners_of(view, mesh, x, y)
            .add_squares(mesh, highlight_count, sampling, stride * stride,
                         rows_.data() + piece * sums_.size());
      }
    }
  });
  std::ranges::fill(sums_, MaterialWeights());
  for (std::size_t i = 0; i < rows_.size(); ++i) sums_[i % sums_.size()] += rows_[i];
}

}  // namespace rimlight
