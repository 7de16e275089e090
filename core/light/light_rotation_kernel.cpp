#include "core/light/light_rotation_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/light/light_rotation_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rimlight {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using F32 = hn::CappedTag<float, kOverlapLanes>;
using V = hn::Vec<F32>;
constexpr F32 kF32{};

HWY_INLINE V set(float value) { return hn::Set(kF32, value); }
HWY_INLINE V clamped(V value, V low, V high) { return hn::Min(hn::Max(value, low), high); }

constexpr std::size_t kEdges = 4;

/// One edge of the quadrilateral, turned so that u does not fall; `sign` undoes the turn. A point
/// is (u0 + t·du, v0 + t·dv), t in [0, 1].
struct Edge {
  V u0, v0, du, dv, per_u, per_v, sign;
};

HWY_INLINE Edge make_edge(V ua, V va, V ub, V vb) {
  // Below this an edge counts as parallel to the grid lines: far less than a coordinate's rounding,
  // and its inverse times any coordinate is finite.
  const V tiny = set(1e-12f);
  const auto falls = hn::Gt(ua, ub);
  Edge edge;
  edge.u0 = hn::Min(ua, ub);
  edge.v0 = hn::IfThenElse(falls, vb, va);
  edge.du = hn::Sub(hn::Max(ua, ub), edge.u0);
  edge.dv = hn::Sub(hn::IfThenElse(falls, va, vb), edge.v0);
  edge.per_u = hn::Div(set(1), hn::Max(edge.du, tiny));
  edge.per_v = hn::Div(set(1), hn::CopySign(hn::Max(hn::Abs(edge.dv), tiny), edge.dv));
  edge.sign = hn::IfThenElse(falls, set(-1), set(1));
  return edge;
}

/// The part of an edge inside a row of cells, and how far along it the current column begins.
struct EdgePart {
  V begin, end;  // t
  V column;      // t where the edge meets the column's low line, within [begin, end]
  V v_end;       // v at `end`, from the row's low line
};

/// ρ over one cell with (u, v) from its low corner: solid_angle · (k + ku·u + kv·v + kuu·u² + …).
struct CellDensity {
  V k, kv, kvv;  // of P = u·(k + kv·v + kvv·v² + u·(half_ku + half_kuv·v + u·third_kuu))
  V half_ku, half_kuv, third_kuu;
  V full, half_full_v;  // of ∫ over the cell's whole width and from 0 to v:
  V third_kvv;          //   v·(full + v·(half_full_v + v·third_kvv))
  V solid_angle;        // ρ at the middle times the cell's area
};

/// `x`, `y`: the cell's middle in the face's plane; `h`: its side there. With q = 1 + x² + y²:
/// ρx/ρ = −3x/q, ρxx/ρ = 15x²/q² − 3/q, ρxy/ρ = 15xy/q².
HWY_INLINE CellDensity cell_density(V x, V y, V h) {
  const V per_q = hn::Div(set(1), hn::MulAdd(x, x, hn::MulAdd(y, y, set(1))));
  const V hh = hn::Mul(h, h);
  const V xs = hn::Mul(hn::Mul(x, h), per_q);
  const V ys = hn::Mul(hn::Mul(y, h), per_q);
  const V flat = hn::Mul(set(-1.5f), hn::Mul(hh, per_q));
  // ρ/ρ(middle) = 1 + au + bv + cu² + duv + ev² about the middle …
  const V a = hn::Mul(set(-3), xs);
  const V b = hn::Mul(set(-3), ys);
  const V c = hn::MulAdd(set(7.5f), hn::Mul(xs, xs), flat);
  const V d = hn::Mul(set(15), hn::Mul(xs, ys));
  const V e = hn::MulAdd(set(7.5f), hn::Mul(ys, ys), flat);
  // … and from the low corner, half a cell away.
  const V half = set(0.5f);
  const V ku = hn::Sub(hn::Sub(a, c), hn::Mul(half, d));
  CellDensity cell;
  cell.k =
      hn::MulAdd(set(0.25f), hn::Add(hn::Add(c, d), e), hn::NegMulAdd(half, hn::Add(a, b), set(1)));
  cell.kv = hn::Sub(hn::Sub(b, e), hn::Mul(half, d));
  cell.kvv = e;
  cell.half_ku = hn::Mul(half, ku);
  cell.half_kuv = hn::Mul(half, d);
  cell.third_kuu = hn::Mul(set(1.0f / 3), c);
  cell.full = hn::Add(hn::Add(cell.k, cell.half_ku), cell.third_kuu);
  cell.half_full_v = hn::Mul(half, hn::Add(cell.kv, cell.half_kuv));
  cell.third_kvv = hn::Mul(set(1.0f / 3), e);
  cell.solid_angle = hn::Mul(hh, hn::Mul(per_q, hn::Sqrt(per_q)));
  return cell;
}

/// P(u, v) = ∫ρ du from the cell's low line to u.
HWY_INLINE V row_integral(const CellDensity& cell, V u, V v) {
  const V linear = hn::MulAdd(v, hn::MulAdd(v, cell.kvv, cell.kv), cell.k);
  const V quadratic = hn::MulAdd(u, cell.third_kuu, hn::MulAdd(v, cell.half_kuv, cell.half_ku));
  return hn::Mul(u, hn::MulAdd(u, quadratic, linear));
}

/// ∫ρ over the cell's whole width from its low line to v.
HWY_INLINE V full_integral(const CellDensity& cell, V v) {
  return hn::Mul(v, hn::MulAdd(v, hn::MulAdd(v, cell.third_kvv, cell.half_full_v), cell.full));
}

/// What one edge adds to a cell: ∫ P dv over its part inside the cell's column, and the cell's
/// whole width over its part to the right. `column` and `row`: the cell's low corner.
HWY_INLINE V edge_integral(const Edge& edge, const CellDensity& cell, V column, V row,
                           EdgePart& part) {
  const V next =
      clamped(hn::Mul(hn::Sub(hn::Add(column, set(1)), edge.u0), edge.per_u), part.begin, part.end);
  const V half = hn::Mul(set(0.5f), hn::Sub(next, part.column));
  const V middle = hn::Mul(set(0.5f), hn::Add(next, part.column));
  const V offset = hn::Mul(set(0.57735027f), half);  // Gauss–Legendre, 2 points: 1/√3
  const V t0 = hn::Sub(middle, offset);
  const V t1 = hn::Add(middle, offset);
  const V u_low = hn::Sub(edge.u0, column);
  const V v_low = hn::Sub(edge.v0, row);
  const V p0 = row_integral(cell, hn::MulAdd(t0, edge.du, u_low), hn::MulAdd(t0, edge.dv, v_low));
  const V p1 = row_integral(cell, hn::MulAdd(t1, edge.du, u_low), hn::MulAdd(t1, edge.dv, v_low));
  const V right = hn::Sub(full_integral(cell, part.v_end),
                          full_integral(cell, hn::MulAdd(next, edge.dv, v_low)));
  part.column = next;
  return hn::Mul(edge.sign, hn::MulAdd(hn::Mul(half, edge.dv), hn::Add(p0, p1), right));
}

/// t where the edge meets the line v = row.
HWY_INLINE V meets_row(const Edge& edge, V row) {
  return clamped(hn::Mul(hn::Sub(row, edge.v0), edge.per_v), set(0), set(1));
}

HWY_INLINE EdgePart part_in_row(const Edge& edge, V row) {
  const V low = meets_row(edge, row);
  const V high = meets_row(edge, hn::Add(row, set(1)));
  EdgePart part;
  part.begin = hn::Min(low, high);
  part.end = hn::Max(low, high);
  part.column = clamped(hn::Mul(hn::Sub(set(0), edge.u0), edge.per_u), part.begin, part.end);
  part.v_end = hn::MulAdd(part.end, edge.dv, hn::Sub(edge.v0, row));
  return part;
}

/// Solid angles shared by the lanes from `lane` on with the cells of their boxes: weights[row ·
/// columns + column][lane].
HWY_INLINE void overlap_weights(const OverlapBatch& batch, int size, std::size_t lane,
                                float* HWY_RESTRICT weights) {
  Edge edges[kEdges];
  for (std::size_t i = 0; i < kEdges; ++i) {
    const std::size_t next = (i + 1) % kEdges;
    edges[i] =
        make_edge(hn::Load(kF32, batch.u[i] + lane), hn::Load(kF32, batch.v[i] + lane),
                  hn::Load(kF32, batch.u[next] + lane), hn::Load(kF32, batch.v[next] + lane));
  }
  const V h = set(2.0f / static_cast<float>(size));
  const V box_x = hn::MulAdd(hn::Load(kF32, batch.box_u + lane), h, set(-1));
  const V box_y = hn::MulAdd(hn::Load(kF32, batch.box_v + lane), h, set(-1));
  float* HWY_RESTRICT cell_weights = weights + lane;
  for (int j = 0; j < batch.rows; ++j) {
    const V row = set(static_cast<float>(j));
    const V y = hn::MulAdd(hn::Add(row, set(0.5f)), h, box_y);
    EdgePart parts[kEdges];
    for (std::size_t i = 0; i < kEdges; ++i) parts[i] = part_in_row(edges[i], row);
    for (int c = 0; c < batch.columns; ++c) {
      const V column = set(static_cast<float>(c));
      const CellDensity cell = cell_density(hn::MulAdd(hn::Add(column, set(0.5f)), h, box_x), y, h);
      V sum = hn::Zero(kF32);
      for (std::size_t i = 0; i < kEdges; ++i) {
        sum = hn::Add(sum, edge_integral(edges[i], cell, column, row, parts[i]));
      }
      // A cell that is only touched may come out a rounding below zero.
      const V weight = hn::Max(hn::Mul(sum, cell.solid_angle), hn::Zero(kF32));
      hn::Store(weight, kF32, cell_weights);
      cell_weights += kOverlapLanes;
    }
  }
}

void add_overlaps_target(const OverlapBatch& batch, int size, float* HWY_RESTRICT energy) {
  alignas(64) float weights[kLargestOverlapSide * kLargestOverlapSide * kOverlapLanes];
  for (std::size_t lane = 0; lane < batch.count; lane += hn::Lanes(kF32)) {
    overlap_weights(batch, size, lane, weights);
  }
  const hn::CappedTag<float, 4> rgb;  // one lane at a time on the scalar target
  for (std::size_t lane = 0; lane < batch.count; ++lane) {
    const float* weight = weights + lane;
    for (int j = 0; j < batch.rows; ++j) {
      float* texel = energy + 4 * (batch.first_texel[lane] +
                                   static_cast<std::size_t>(j) * static_cast<std::size_t>(size));
      for (int c = 0; c < batch.columns; ++c, texel += 4, weight += kOverlapLanes) {
        const auto share = hn::Set(rgb, *weight);
        for (std::size_t k = 0; k < 4; k += hn::Lanes(rgb)) {
          const auto radiance = hn::Load(rgb, batch.radiance[lane] + k);
          hn::Store(hn::MulAdd(share, radiance, hn::Load(rgb, texel + k)), rgb, texel + k);
        }
      }
    }
  }
}

void project_corners_target(const CornerRow& row, int size, std::size_t count,
                            float* HWY_RESTRICT u, float* HWY_RESTRICT v,
                            std::int32_t* HWY_RESTRICT face) {
  const hn::RebindToSigned<F32> i32;
  const V half_size = set(0.5f * static_cast<float>(size));
  const V most = set(static_cast<float>(size));
  for (std::size_t i = 0; i < count; i += hn::Lanes(kF32)) {
    const V index = hn::Iota(kF32, static_cast<float>(i));
    const V x = hn::MulAdd(index, set(row.step.x), set(row.origin.x));
    const V y = hn::MulAdd(index, set(row.step.y), set(row.origin.y));
    const V z = hn::MulAdd(index, set(row.step.z), set(row.origin.z));
    const V ax = hn::Abs(x), ay = hn::Abs(y), az = hn::Abs(z);
    const auto on_x = hn::And(hn::Ge(ax, ay), hn::Ge(ax, az));
    const auto on_y = hn::Ge(ay, az);  // where not on_x
    // Faces' axes as in cube::face_axes: (right, up) = (y, z), (z, x), (x, y) on the positive
    // faces, exchanged on the negative ones.
    const V depth = hn::IfThenElse(on_x, x, hn::IfThenElse(on_y, y, z));
    const V first = hn::IfThenElse(on_x, y, hn::IfThenElse(on_y, z, x));
    const V second = hn::IfThenElse(on_x, z, hn::IfThenElse(on_y, x, y));
    const auto negative = hn::Lt(depth, hn::Zero(kF32));
    const V scale = hn::Div(half_size, hn::Abs(depth));
    const V right = hn::IfThenElse(negative, second, first);
    const V up = hn::IfThenElse(negative, first, second);
    hn::Store(clamped(hn::MulAdd(right, scale, half_size), hn::Zero(kF32), most), kF32, u + i);
    hn::Store(clamped(hn::MulAdd(up, scale, half_size), hn::Zero(kF32), most), kF32, v + i);
    const V axis = hn::IfThenElse(on_x, set(0), hn::IfThenElse(on_y, set(2), set(4)));
    const V number = hn::Add(axis, hn::IfThenElse(negative, set(1), set(0)));
    hn::Store(hn::ConvertTo(i32, number), i32, face + i);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {

HWY_EXPORT(add_overlaps_target);
HWY_EXPORT(project_corners_target);

void add_overlaps(const OverlapBatch& batch, int size, std::span<float> energy) noexcept {
  HWY_DYNAMIC_DISPATCH(add_overlaps_target)(batch, size, energy.data());
}

void project_corners(const CornerRow& row, int size, std::span<float> u, std::span<float> v,
                     std::span<std::int32_t> face) noexcept {
  HWY_DYNAMIC_DISPATCH(project_corners_target)
  (row, size, u.size(), u.data(), v.data(), face.data());
}

}  // namespace rimlight
#endif
