#include "core/relight/relighter.h"

#include <algorithm>
#include <atomic>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/transport/receiver_planes.h"

namespace rimlight {

Relighter::Relighter(const TransportView& transport, const ReceiverValues& reflectance,
                     const CubeHaar& basis, HeldImages images)
    : transport_(transport),
      reflectance_(reflectance),
      basis_(basis),
      holds_bands_(images == HeldImages::by_band) {
  held_.fill(CubeLight(basis.size()));
  RIMLIGHT_CHECK_EQ(transport.column_count(), basis.coefficient_count());
  RIMLIGHT_CHECK_EQ(reflectance.tile_count(), transport.tile_count());
  const auto bands = static_cast<std::size_t>(basis.band_count());
  for (std::size_t i = 0; i < (holds_bands_ ? bands : 1); ++i) {
    images_.emplace_back(transport.tile_count());
    fresh_.emplace_back(transport.tile_count());
  }
  zero_.assign(images_.size(), true);
  was_zero_.reserve(images_.size());
  fresh_plan_.bands.reserve(bands);  // the first rebuild may come late
  fresh_plan_.columns.reserve(kLayers * basis.coefficient_count());
}

void Relighter::update_tile(const UpdatePlan& plan, const std::vector<bool>& is_zero,
                            std::size_t tile, std::vector<ReceiverValues>& images) const {
  if (!holds_bands_) {
    float* const held = images[0].tile(tile);
    const bool starts_from_zero = plan.bands[0].action == BandAction::reset || is_zero[0];
    if (starts_from_zero) std::fill_n(held, kTileFloats, 0.0f);
    add_columns(transport_, tile, plan.columns, held);
    return;
  }
  for (std::size_t b = 0; b < plan.bands.size(); ++b) {
    const BandUpdate& update = plan.bands[b];
    if (update.count == 0) continue;  // a reset without columns is told by zero_ alone
    float* const held = images[b].tile(tile);
    const bool starts_from_zero = update.action == BandAction::reset || is_zero[b];
    if (starts_from_zero) std::fill_n(held, kTileFloats, 0.0f);
    add_columns(transport_, tile, std::span(plan.columns).subspan(update.first, update.count),
                held);
  }
}

void Relighter::sum_fresh_bands(std::size_t tile, float* image) const {
  alignas(64) std::array<float, kTileFloats> band;
  std::fill_n(image, kTileFloats, 0.0f);
  for (const BandUpdate& update : fresh_plan_.bands) {
    if (update.count == 0) continue;
    band.fill(0);
    add_columns(transport_, tile,
                std::span(fresh_plan_.columns).subspan(update.first, update.count), band.data());
    for (std::size_t i = 0; i < kTileFloats; ++i) image[i] += band[i];
  }
}

void Relighter::move_held(const UpdatePlan& plan, const CubeLight& target) {
  for (std::size_t b = 0; b < plan.bands.size(); ++b) {
    const BandUpdate& update = plan.bands[b];
    const std::size_t image = holds_bands_ ? b : 0;
    if (update.action == BandAction::reset) {
      const std::size_t begin = basis_.band_begin(static_cast<int>(b));
      const std::size_t end = basis_.band_begin(static_cast<int>(b) + 1);
      for (CubeLight& layer : held_) {
        for (int c = 0; c < 3; ++c) {
          std::ranges::fill(layer.channel(c).subspan(begin, end - begin), 0.0f);
        }
      }
      if (holds_bands_ || b == 0) zero_[image] = true;
    }
    if (update.count > 0) zero_[image] = false;
  }
  last_terms_ = plan.column_count();
  // The target itself, not held + delta, which may round beside it.
  for (const ColumnDelta& column : plan.columns) {
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      if ((column.layers >> layer & 1) == 0) continue;
      for (int c = 0; c < 3; ++c) {
        held_[layer].channel(c)[column.column] = target.channel(c)[column.column];
      }
    }
  }
}

void Relighter::check_resets(const UpdatePlan& plan) const {
  if (holds_bands_) return;
  const auto resets = static_cast<std::size_t>(
      std::ranges::count(plan.bands, BandAction::reset, &BandUpdate::action));
  RIMLIGHT_CHECK(resets == 0 || resets == plan.bands.size());
}

void Relighter::apply(const UpdatePlan& plan, const CubeLight& target) {
  RIMLIGHT_CHECK_EQ(plan.bands.size(), static_cast<std::size_t>(basis_.band_count()));
  check_resets(plan);
  RIMLIGHT_CHECK_EQ(target.count(), basis_.coefficient_count());
  RIMLIGHT_CHECK(plan.columns.empty() || plan.columns.back().column < transport_.column_count());
  was_zero_ = zero_;
  move_held(plan, target);
  choose_rebuilt_tiles(plan);
  if (plan.columns.empty()) return;
  // Tiles to rebuild come first: they take longest.
  const auto update = [&](std::size_t i) {
    const std::size_t tile = (next_rebuilt_ + i) % tile_count();
    update_tile(i < tiles_rebuilt_ ? fresh_plan_ : plan, was_zero_, tile, images_);
  };
  parallel_for(tile_count(), update);
  next_rebuilt_ = (next_rebuilt_ + tiles_rebuilt_) % tile_count();
}

void Relighter::choose_rebuilt_tiles(const UpdatePlan& plan) {
  std::array<std::size_t, kLayers> additions{};
  for (const ColumnDelta& column : plan.columns) {
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      additions[layer] += column.layers >> layer & 1;
    }
  }
  // One round through all tiles for every kMostAdditions columns added.
  const std::size_t most = *std::ranges::max_element(additions);
  rebuild_credit_ = std::min(rebuild_credit_ + most * tile_count(), kMostAdditions * tile_count());
  tiles_rebuilt_ = most == 0 ? 0 : rebuild_credit_ / kMostAdditions;
  if (tiles_rebuilt_ == 0) return;
  rebuild_credit_ -= tiles_rebuilt_ * kMostAdditions;
  plan_afresh(held_);
  // What came back to black column by column shows rounding alone: none of it is kept.
  for (std::size_t i = 0; i < images_.size(); ++i) {
    zero_[i] = holds_bands_ ? fresh_plan_.bands[i].count == 0 : fresh_plan_.columns.empty();
  }
}

void Relighter::plan_afresh(const HeldLight& light) {
  fresh_plan_.bands.assign(static_cast<std::size_t>(basis_.band_count()), {});
  fresh_plan_.columns.clear();
  for (std::size_t b = 0; b < fresh_plan_.bands.size(); ++b) {
    BandUpdate& update = fresh_plan_.bands[b];
    update = {BandAction::reset, fresh_plan_.columns.size(), 0};
    for (auto i = basis_.band_begin(static_cast<int>(b));
         i < basis_.band_begin(static_cast<int>(b) + 1); ++i) {
      std::array<Vec3f, kLayers> values;
      for (std::size_t layer = 0; layer < kLayers; ++layer)
        values[layer] = light.layer(layer).at(i);
      append_deltas(i, values, kAllLayers, fresh_plan_.columns);
    }
    update.count = fresh_plan_.columns.size() - update.first;
  }
}

bool Relighter::apply_exact(const CubeLight& target, const std::function<bool()>& abandon) {
  RIMLIGHT_CHECK_EQ(target.count(), basis_.coefficient_count());
  plan_afresh(target);
  std::atomic<bool> abandoned = false;
  const auto update = [&](std::size_t tile) {
    if (abandoned.load(std::memory_order_relaxed)) return;
    if (abandon && abandon()) {
      abandoned.store(true, std::memory_order_relaxed);
    } else if (holds_bands_) {
      update_tile(fresh_plan_, zero_, tile, fresh_);
    } else {
      sum_fresh_bands(tile, fresh_[0].tile(tile));
    }
  };
  parallel_for(tile_count(), update);
  if (abandoned) return false;
  images_.swap(fresh_);
  rebuild_credit_ = 0;
  move_held(fresh_plan_, target);
  return true;
}

void Relighter::sum_bands(std::size_t tile, std::span<float, kTileFloats> held) const {
  std::ranges::fill(held, 0.0f);
  // A part of all bands before the next part: what is summed so far stays in the nearest cache.
  constexpr std::size_t kPart = 1024;
  static_assert(kTileFloats % kPart == 0);
  for (std::size_t begin = 0; begin < kTileFloats; begin += kPart) {
    for (std::size_t b = 0; b < images_.size(); ++b) {
      if (zero_[b]) continue;
      const float* const band = images_[b].tile(tile) + begin;
      for (std::size_t i = 0; i < kPart; ++i) held[begin + i] += band[i];
    }
  }
}

void Relighter::find_radiance(std::size_t tile, std::span<float, kTileFloats> radiance) const {
  sum_bands(tile, radiance);
  restore_radiance(radiance, reflectance_.tile_span(tile));
}

}  // namespace rimlight
