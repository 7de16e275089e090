// The product is compiled once for each SIMD target; the one in use is chosen at the first call.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/transport/sketch.cpp"
#include "core/transport/sketch.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep; before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/math/random.h"
#include "core/transport/pixel_haar.h"
#include "core/transport/receiver_planes.h"

HWY_BEFORE_NAMESPACE();
namespace rimlight {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// sums[kSketchRows] += Σ_j light[j] · scale[j] · rows[j][kSketchRows].
void add_sketched_impl(const std::int8_t* HWY_RESTRICT rows, const float* HWY_RESTRICT scale,
                       std::span<const float> light, float* HWY_RESTRICT sums) {
  const hn::CappedTag<float, 16> floats;
  const hn::RebindToSigned<decltype(floats)> integers;
  const hn::Rebind<std::int8_t, decltype(floats)> bytes;
  const std::size_t lanes = hn::Lanes(floats);
  for (std::size_t j = 0; j < light.size(); ++j, rows += kSketchRows) {
    if (light[j] == 0) continue;
    const auto factor = hn::Set(floats, light[j] * scale[j]);
    for (std::size_t k = 0; k < kSketchRows; k += lanes) {
      const auto value = hn::ConvertTo(floats, hn::PromoteTo(integers, hn::Load(bytes, rows + k)));
      hn::Store(hn::MulAdd(factor, value, hn::Load(floats, sums + k)), floats, sums + k);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rimlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rimlight {
namespace {

HWY_EXPORT(add_sketched_impl);

constexpr std::size_t kLanes = PixelLayout::kGroupReceivers;
constexpr std::uint64_t kSignSeed = 0x5167;
constexpr std::uint64_t kRowSeed = 0x7035;

/// The signs of a group's 64 receivers in one channel, as the bits of one number.
std::uint64_t sign_bits(std::size_t group, std::size_t channel) {
  return Random(kSignSeed, group * 3 + channel).bits();
}

float sign_of(std::uint64_t bits, std::size_t lane) {
  return (bits >> lane & 1) != 0 ? -1.0f : 1.0f;
}

/// So many units fit an int32, and float's rounding near them.
constexpr float kMostUnits = 0x1p30f;

/// Sums of a column, or of a layer of it: [3][kSketchRows], and Σ M̂² of each channel.
struct ColumnSketch {
  std::array<std::array<double, kSketchRows>, 3> row{};
  std::array<double, 3> square{};

  void add_group(std::size_t group, const float* radiance) {  // [8 blocks][3][8]
    const std::size_t first = sketch_first_row(group);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint64_t bits = sign_bits(group, c);
      for (std::size_t i = 0; i < kLanes; ++i) {
        const double m = static_cast<double>(radiance[i / kBlockReceivers * kBlockFloats +
                                                      c * kBlockReceivers + i % kBlockReceivers]);
        row[c][first + i] += static_cast<double>(sign_of(bits, i)) * m;
        square[c] += m * m;
      }
    }
  }
};

/// A column's layers, and all of them.
struct LayeredSketch {
  std::array<ColumnSketch, kLayers> layer;
  ColumnSketch whole;
};

constexpr std::size_t kGroups = kTileReceivers / kLanes;

/// One tile of a column's layer in radiance, group by group.
struct TileLayer {
  alignas(64) std::array<float, kTileFloats> held;
  std::array<bool, kGroups> used;

  void add(const RunBlock& block, float step) {
    const std::size_t group = block.index / kBlockReceivers;
    if (!used[group]) std::fill_n(held.data() + group * kGroupFloats, kGroupFloats, 0.0f);
    used[group] = true;
    const Vec3f factor = kPlaneFactors[block.plane] * step;
    float* const to = held.data() + block.index * kBlockFloats;
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < kBlockReceivers; ++i) {
        to[c * kBlockReceivers + i] += factor[static_cast<int>(c)] * block.value[i];
      }
    }
  }

  /// From pixel Haar coefficients before reflectance.
  void restore(std::size_t group, const float* reflectance) {
    float* const of_group = held.data() + group * kGroupFloats;
    for (std::size_t c = 0; c < 3; ++c)
      pixel_haar_inverse(of_group + c * kBlockReceivers, kBlockFloats);
    for (std::size_t i = 0; i < kGroupFloats; ++i) {
      of_group[i] *= reflectance[group * kGroupFloats + i];
    }
  }
};

/// Adds one tile's run: its groups decoded to radiance.
void add_tile(const TransportView& stored, const ReceiverValues& reflectance, std::size_t tile,
              std::size_t column, LayeredSketch& sketch) {
  const ColumnRun run = stored.run(tile, column);
  if (run.empty()) return;
  thread_local std::array<TileLayer, kLayers> layers;
  for (TileLayer& layer : layers) layer.used.fill(false);
  for (RunCursor at(run); !at.at_end(); at.next()) {
    layers[layer_of(at.width())].add(at.block(), stored.step(column));
  }
  for (std::size_t group = 0; group < kGroups; ++group) {
    std::array<float, kGroupFloats> whole{};
    bool used = false;
    for (std::size_t l = 0; l < kLayers; ++l) {
      if (!layers[l].used[group]) continue;
      used = true;
      layers[l].restore(group, reflectance.tile(tile));
      const float* const radiance = layers[l].held.data() + group * kGroupFloats;
      sketch.layer[l].add_group(tile * kGroups + group, radiance);
      for (std::size_t i = 0; i < kGroupFloats; ++i) whole[i] += radiance[i];
    }
    if (used) sketch.whole.add_group(tile * kGroups + group, whole.data());
  }
}

/// Eight bits and a scale.
void quantize(const std::array<double, kSketchRows>& row, std::int8_t* bytes, float& scale) {
  double largest = 0;
  for (const double value : row) largest = std::max(largest, std::abs(value));
  scale = static_cast<float>(largest / 127);
  for (std::size_t k = 0; k < kSketchRows; ++k) {
    bytes[k] = scale > 0 ? static_cast<std::int8_t>(std::lround(row[k] * 127 / largest)) : 0;
  }
}

}  // namespace

float sketch_sign(std::size_t receiver, std::size_t channel) {
  return sign_of(sign_bits(receiver / kLanes, channel), receiver % kLanes);
}

std::size_t sketch_first_row(std::size_t group) {
  return kLanes * Random(kRowSeed, group).below(kSketchRows / kLanes);
}

SketchSums::SketchSums(std::size_t column_count, float unit)
    : unit_(unit), sums_(column_count * 3 * kSketchRows) {
  RIMLIGHT_CHECK(unit > 0 && std::isfinite(unit));
}

void SketchSums::add_group(std::size_t first_receiver, std::span<const float> rows) {
  RIMLIGHT_CHECK_EQ(rows.size() * kThirds, sums_.size());
  const std::size_t group = first_receiver / kLanes, first = sketch_first_row(group);
  alignas(64) std::array<float, kGroupFloats> factor;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::uint64_t bits = sign_bits(group, c);
    for (std::size_t i = 0; i < kLanes; ++i) {
      factor[c * kLanes + i] = sign_of(bits, i) / unit_;
    }
  }
  const std::scoped_lock lock(mutexes_[first / kLanes]);
  for (std::size_t at = 0; at < rows.size(); at += kGroupFloats) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float* const m = rows.data() + at + c * kLanes;
      std::int64_t* const sum = sums_.data() + (at / kLanes + c) * kSketchRows + first;
      for (std::size_t i = 0; i < kLanes; ++i) {
        const float units = std::clamp(m[i] * factor[c * kLanes + i], -kMostUnits, kMostUnits);
        sum[i] += static_cast<std::int32_t>(round_to_whole(units));
      }
    }
  }
}

Sketch make_sketch(const SketchSums& sums, const TransportView& stored,
                   const ReceiverValues& reflectance) {
  const std::size_t columns = stored.column_count();
  RIMLIGHT_CHECK_EQ(sums.sums().size(), columns * 3 * kSketchRows);
  RIMLIGHT_CHECK_EQ(reflectance.tile_count(), stored.tile_count());
  const std::size_t parts = columns * kLayers;
  Sketch sketch;
  sketch.column_count = columns;
  sketch.stored.resize(3 * parts * kSketchRows);
  sketch.error.resize(3 * columns * kSketchRows);
  for (auto* const of_parts : {&sketch.stored_scale, &sketch.part_norm_squared}) {
    of_parts->resize(3 * parts);
  }
  for (auto* const of_columns : {&sketch.error_scale, &sketch.norm_squared}) {
    of_columns->resize(3 * columns);
  }
  parallel_for(columns, [&](std::size_t column) {
    LayeredSketch of_stored;
    for (std::size_t tile = 0; tile < stored.tile_count(); ++tile) {
      add_tile(stored, reflectance, tile, column, of_stored);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t at = c * columns + column;
      const auto whole = sums.sums().subspan((column * 3 + c) * kSketchRows, kSketchRows);
      std::array<double, kSketchRows> error;
      for (std::size_t k = 0; k < kSketchRows; ++k) {
        error[k] = static_cast<double>(whole[k]) * static_cast<double>(sums.unit()) -
                   of_stored.whole.row[c][k];
      }
      quantize(error, sketch.error.data() + at * kSketchRows, sketch.error_scale[at]);
      sketch.norm_squared[at] = static_cast<float>(of_stored.whole.square[c]);
      for (std::size_t layer = 0; layer < kLayers; ++layer) {
        const std::size_t part = c * parts + part_of(column, layer);
        quantize(of_stored.layer[layer].row[c], sketch.stored.data() + part * kSketchRows,
                 sketch.stored_scale[part]);
        sketch.part_norm_squared[part] = static_cast<float>(of_stored.layer[layer].square[c]);
      }
    }
  });
  return sketch;
}

SketchedImages& SketchedImages::operator+=(const SketchedImages& other) {
  for (std::size_t k = 0; k < kSketchRows; ++k) {
    residual[k] += other.residual[k];
    left_out[k] += other.left_out[k];
  }
  return *this;
}

double SketchedImages::residual_squared() const {
  double sum = 0;
  for (const float row : residual) sum += static_cast<double>(row) * static_cast<double>(row);
  return sum;
}

double SketchedImages::error_squared() const {
  double sum = 0;
  for (std::size_t k = 0; k < kSketchRows; ++k) {
    const double row = static_cast<double>(residual[k]) + static_cast<double>(left_out[k]);
    sum += row * row;
  }
  return sum;
}

SketchedImages sketch_images(const Sketch& sketch, std::size_t channel,
                             std::span<const float> residual, std::span<const float> target,
                             std::size_t first, std::size_t count) {
  RIMLIGHT_CHECK_EQ(residual.size(), sketch.column_count * kLayers);
  RIMLIGHT_CHECK_EQ(target.size(), sketch.column_count);
  RIMLIGHT_CHECK(first <= sketch.column_count && count <= sketch.column_count - first);
  alignas(64) SketchedImages sums;
  const std::size_t part = part_of(channel * sketch.column_count + first, 0);
  HWY_DYNAMIC_DISPATCH(add_sketched_impl)
  (sketch.stored.data() + part * kSketchRows, sketch.stored_scale.data() + part,
   residual.subspan(part_of(first, 0), count * kLayers), sums.residual.data());
  const std::size_t column = channel * sketch.column_count + first;
  HWY_DYNAMIC_DISPATCH(add_sketched_impl)
  (sketch.error.data() + column * kSketchRows, sketch.error_scale.data() + column,
   target.subspan(first, count), sums.left_out.data());
  return sums;
}

}  // namespace rimlight
#endif  // HWY_ONCE
