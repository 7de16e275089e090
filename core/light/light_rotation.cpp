#include "core/light/light_rotation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/check.h"
#include "core/light/cube_splat.h"
#include "core/light/light_rotation_kernel.h"

namespace rimlight {
namespace {

/// Of the mean radiance of a channel: what exceeds it is bound to cover at most 1/16 of the sphere.
constexpr double kCapOfMean = 16;

/// Below this many texels a side a texel is no small patch of the sphere any more, and its corners
/// may lie behind a face that it touches: smaller lights are rotated as finer ones.
constexpr int kSmallestWorkingSize = 16;

/// One piece of a texel's excess.
struct Piece {
  Vec3f direction;
  Vec3f energy;  // radiance times solid angle
};

/// One row of texel corners, rotated and projected to the faces that they meet.
struct ProjectedRow {
  CornerRow corners;
  AlignedVector<float> u, v;         // [size + 1, padded]
  AlignedVector<std::int32_t> face;  // [size + 1, padded]
};

/// Source texel (or a part of one) as a quadrilateral in a face's plane, in cells.
struct Quadrilateral {
  std::array<float, 4> u, v;
};

/// The texel in the middle of which (or in a part of which) a finer light's texel lies.
std::size_t coarse_texel(std::size_t fine, int fine_size, int factor) {
  const int index = static_cast<int>(fine), size = fine_size / factor;
  const int face = index / (fine_size * fine_size);
  const int row = index / fine_size % fine_size / factor;
  const int column = index % fine_size / factor;
  const int texel = (face * size + row) * size + column;
  return static_cast<std::size_t>(texel);
}

}  // namespace

/// Everything that rotation needs beside the source; works on a light of at least
/// kSmallestWorkingSize, `factor` texels a side for each one of the source.
class LightRotator::Workspace {
 public:
  explicit Workspace(const CubeLight& source);
  void rotate(const Quaternion& rotation, CubeLight& target);

 private:
  void split(const CubeLight& source);
  void cut_up(std::size_t texel, const Vec3d& energy);
  void project_row(const Matrix3& turn, int face, int row);
  void add_row(int face, int row);
  void add_straddling(const ProjectedRow& low, const ProjectedRow& high, std::size_t column,
                      std::size_t texel);
  void add_quadrilateral(int face, const Quadrilateral& quadrilateral, std::size_t texel);
  void add_to_batch(OverlapBatch& batch, int face, int column, int row,
                    const Quadrilateral& quadrilateral, std::size_t texel);
  void flush(OverlapBatch& batch);
  void splat_excess(const Matrix3& turn);
  void finish(CubeLight& target) const;

  int factor_;
  int size_;
  CubeSplat splat_;
  AlignedVector<float> base_;    // [texel][4]: red, green, blue, unused
  AlignedVector<float> energy_;  // [texel][4], of the target
  std::vector<Piece> excess_;
  AlignedVector<float> per_solid_angle_;  // [texel of the source's size]
  std::array<ProjectedRow, 2> rows_;      // the last two
  std::array<OverlapBatch, kLargestOverlapSide * kLargestOverlapSide> batches_;
};

LightRotator::Workspace::Workspace(const CubeLight& source)
    : factor_((kSmallestWorkingSize + source.size - 1) / source.size),
      size_(source.size * factor_),
      splat_(size_),
      base_(4 * cube::texel_count(size_)),
      energy_(base_.size()),
      per_solid_angle_(source.count()) {
  for (std::size_t texel = 0; texel < source.count(); ++texel) {
    per_solid_angle_[texel] = static_cast<float>(1 / cube::texel_solid_angle(texel, source.size));
  }
  const auto corners = static_cast<std::size_t>(size_) + 1;
  const std::size_t padded = (corners + kOverlapLanes - 1) / kOverlapLanes * kOverlapLanes;
  for (ProjectedRow& row : rows_) {
    row.u.resize(padded);
    row.v.resize(padded);
    row.face.resize(padded);
  }
  for (std::size_t i = 0; i < batches_.size(); ++i) {
    batches_[i].columns = static_cast<int>(i % kLargestOverlapSide) + 1;
    batches_[i].rows = static_cast<int>(i / kLargestOverlapSide) + 1;
  }
  split(source);
}

void LightRotator::Workspace::split(const CubeLight& source) {
  const Vec3d cap = integral(source) * (kCapOfMean / (4 * std::numbers::pi));
  for (std::size_t texel = 0; texel < cube::texel_count(size_); ++texel) {
    const Vec3f radiance = source.at(coarse_texel(texel, size_, factor_));
    Vec3d excess;
    for (int c = 0; c < 3; ++c) {
      const float base = std::min(radiance[c], static_cast<float>(cap[c]));
      base_[4 * texel + static_cast<std::size_t>(c)] = base;
      excess[c] = static_cast<double>(radiance[c]) - static_cast<double>(base);
    }
    if (max_component(excess) > 0) cut_up(texel, excess * cube::texel_solid_angle(texel, size_));
  }
  excess_.shrink_to_fit();
}

/// Cuts a texel's energy into k × k pieces of at most half the width of the smallest target texel,
/// shared by their solid angles. k depends on the texel only, so that nothing jumps as it turns.
void LightRotator::Workspace::cut_up(std::size_t texel, const Vec3d& energy) {
  const double smallest = cube::texel_solid_angle(0, size_);  // at a face's corner
  const int k =
      static_cast<int>(std::ceil(2 * std::sqrt(cube::texel_solid_angle(texel, size_) / smallest)));
  const int index = static_cast<int>(texel);
  const int face = index / (size_ * size_), row = index / size_ % size_, column = index % size_;
  const auto piece_point = [&](int i, int j) {
    return cube::FacePoint{face, (2 * column + (2 * i + 1.0) / k) / size_ - 1,
                           (2 * row + (2 * j + 1.0) / k) / size_ - 1};
  };
  const auto density = [](const cube::FacePoint& p) {
    return std::pow(1 + p.x * p.x + p.y * p.y, -1.5);
  };
  double sum = 0;
  for (int i = 0; i < k * k; ++i) sum += density(piece_point(i % k, i / k));
  for (int i = 0; i < k * k; ++i) {
    const cube::FacePoint point = piece_point(i % k, i / k);
    excess_.push_back({Vec3f(cube::direction(point)), Vec3f(energy * (density(point) / sum))});
  }
}

void LightRotator::Workspace::rotate(const Quaternion& rotation, CubeLight& target) {
  const Matrix3 turn = matrix(normalized(rotation));
  std::fill(energy_.begin(), energy_.end(), 0.0f);
  for (int face = 0; face < cube::kFaces; ++face) {
    project_row(turn, face, 0);
    for (int row = 0; row < size_; ++row) {
      project_row(turn, face, row + 1);
      add_row(face, row);
    }
  }
  for (OverlapBatch& batch : batches_) flush(batch);
  splat_excess(turn);
  finish(target);
}

void LightRotator::Workspace::project_row(const Matrix3& turn, int face, int row) {
  const cube::FaceAxes& axes = cube::face_axes(face);
  ProjectedRow& projected = rows_[static_cast<std::size_t>(row % 2)];
  const double y = 2.0 * row / size_ - 1;
  projected.corners = {Vec3f(turn * (axes.axis - axes.right + axes.up * y)),
                       Vec3f(turn * axes.right * (2.0 / size_))};
  project_corners(projected.corners, size_, projected.u, projected.v, projected.face);
}

void LightRotator::Workspace::add_row(int face, int row) {
  const ProjectedRow& low = rows_[static_cast<std::size_t>(row % 2)];
  const ProjectedRow& high = rows_[static_cast<std::size_t>((row + 1) % 2)];
  const auto columns = static_cast<std::size_t>(size_);
  std::size_t texel = static_cast<std::size_t>(face * size_ + row) * columns;
  for (std::size_t i = 0; i < columns; ++i, ++texel) {
    const std::int32_t home = low.face[i];
    if (home == low.face[i + 1] && home == high.face[i] && home == high.face[i + 1]) {
      add_quadrilateral(home,
                        {{low.u[i], low.u[i + 1], high.u[i + 1], high.u[i]},
                         {low.v[i], low.v[i + 1], high.v[i + 1], high.v[i]}},
                        texel);
    } else {
      add_straddling(low, high, i, texel);
    }
  }
}

/// A texel whose corners meet different faces: shown to every face that has all corners before it;
/// the kernel cuts off what lies outside the face.
void LightRotator::Workspace::add_straddling(const ProjectedRow& low, const ProjectedRow& high,
                                             std::size_t column, std::size_t texel) {
  const auto corner = [](const CornerRow& row, std::size_t i) {
    return row.origin + row.step * static_cast<float>(i);
  };
  const std::array<Vec3f, 4> corners = {
      corner(low.corners, column), corner(low.corners, column + 1),
      corner(high.corners, column + 1), corner(high.corners, column)};
  const float half_size = 0.5f * static_cast<float>(size_);
  for (int face = 0; face < cube::kFaces; ++face) {
    const cube::FaceAxes& axes = cube::face_axes(face);
    Quadrilateral quadrilateral{};
    bool in_front = true;
    for (std::size_t i = 0; i < 4; ++i) {
      const float depth = dot(corners[i], Vec3f(axes.axis));
      in_front = in_front && depth > 0;
      quadrilateral.u[i] = half_size * (1 + dot(corners[i], Vec3f(axes.right)) / depth);
      quadrilateral.v[i] = half_size * (1 + dot(corners[i], Vec3f(axes.up)) / depth);
    }
    if (in_front) add_quadrilateral(face, quadrilateral, texel);
  }
}

/// Puts the quadrilateral into the batch of its box's shape; a box too large for one is tiled.
void LightRotator::Workspace::add_quadrilateral(int face, const Quadrilateral& quadrilateral,
                                                std::size_t texel) {
  const auto& [u, v] = quadrilateral;
  const auto most = static_cast<float>(size_);
  const float u_low = std::max(std::min(std::min(u[0], u[1]), std::min(u[2], u[3])), 0.0f);
  const float v_low = std::max(std::min(std::min(v[0], v[1]), std::min(v[2], v[3])), 0.0f);
  const float u_high = std::min(std::max(std::max(u[0], u[1]), std::max(u[2], u[3])), most);
  const float v_high = std::min(std::max(std::max(v[0], v[1]), std::max(v[2], v[3])), most);
  if (!(u_low < u_high && v_low < v_high)) return;  // beside the face
  const int column_end = static_cast<int>(std::ceil(u_high));
  const int row_end = static_cast<int>(std::ceil(v_high));
  for (int row = static_cast<int>(v_low); row < row_end; row += kLargestOverlapSide) {
    for (int column = static_cast<int>(u_low); column < column_end; column += kLargestOverlapSide) {
      const int columns = std::min(column_end - column, kLargestOverlapSide);
      const int rows = std::min(row_end - row, kLargestOverlapSide);
      const auto shape = static_cast<std::size_t>((rows - 1) * kLargestOverlapSide + columns - 1);
      add_to_batch(batches_[shape], face, column, row, quadrilateral, texel);
    }
  }
}

void LightRotator::Workspace::add_to_batch(OverlapBatch& batch, int face, int column, int row,
                                           const Quadrilateral& quadrilateral, std::size_t texel) {
  const std::size_t lane = batch.count++;
  const auto box_u = static_cast<float>(column), box_v = static_cast<float>(row);
  for (std::size_t i = 0; i < 4; ++i) {
    batch.u[i][lane] = quadrilateral.u[i] - box_u;
    batch.v[i][lane] = quadrilateral.v[i] - box_v;
  }
  batch.box_u[lane] = box_u;
  batch.box_v[lane] = box_v;
  batch.first_texel[lane] = static_cast<std::uint32_t>((face * size_ + row) * size_ + column);
  std::copy_n(base_.data() + 4 * texel, 4, batch.radiance[lane]);
  if (batch.count == kOverlapLanes) flush(batch);
}

void LightRotator::Workspace::flush(OverlapBatch& batch) {
  add_overlaps(batch, size_, energy_);
  batch.count = 0;
}

void LightRotator::Workspace::splat_excess(const Matrix3& turn) {
  for (const Piece& piece : excess_) {
    const SplatShares shares = splat_.shares(cube::face_point(turn * Vec3d(piece.direction)));
    for (std::size_t i = 0; i < 4; ++i) {
      float* const texel = energy_.data() + 4 * static_cast<std::size_t>(shares.texel[i]);
      for (int c = 0; c < 3; ++c) texel[c] += shares.weight[i] * piece.energy[c];
    }
  }
}

/// From energies back to mean radiances.
void LightRotator::Workspace::finish(CubeLight& target) const {
  if (factor_ == 1) {
    float* const red = target.channel(0).data();
    float* const green = target.channel(1).data();
    float* const blue = target.channel(2).data();
    for (std::size_t texel = 0; texel < target.count(); ++texel) {
      red[texel] = energy_[4 * texel] * per_solid_angle_[texel];
      green[texel] = energy_[4 * texel + 1] * per_solid_angle_[texel];
      blue[texel] = energy_[4 * texel + 2] * per_solid_angle_[texel];
    }
    return;
  }
  std::fill(target.values.begin(), target.values.end(), 0.0f);
  for (std::size_t fine = 0; fine < cube::texel_count(size_); ++fine) {
    const std::size_t texel = coarse_texel(fine, size_, factor_);
    for (int c = 0; c < 3; ++c) {
      target.channel(c)[texel] +=
          energy_[4 * fine + static_cast<std::size_t>(c)] * per_solid_angle_[texel];
    }
  }
}

LightRotator::LightRotator(CubeLight source) : source_(std::move(source)) {
  RIMLIGHT_CHECK(source_.size >= 1 && source_.size <= cube::kLargestSize);
  RIMLIGHT_CHECK_EQ(source_.values.size(), 3 * cube::texel_count(source_.size));
  for (const float value : source_.values) RIMLIGHT_CHECK(std::isfinite(value) && value >= 0);
  workspace_ = std::make_unique<Workspace>(source_);
}

LightRotator::LightRotator(LightRotator&& other) noexcept = default;
LightRotator& LightRotator::operator=(LightRotator&& other) noexcept = default;
LightRotator::~LightRotator() = default;

void LightRotator::rotate(const Quaternion& rotation, CubeLight& target) {
  constexpr double kUnitTolerance = 1e-6;
  RIMLIGHT_CHECK(std::abs(norm(rotation) - 1) <= kUnitTolerance);
  target.size = source_.size;
  target.values.resize(source_.values.size());
  if (rotation.x == 0 && rotation.y == 0 && rotation.z == 0) {
    std::copy(source_.values.begin(), source_.values.end(), target.values.begin());
    return;
  }
  workspace_->rotate(rotation, target);
}

}  // namespace rimlight
