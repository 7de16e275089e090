#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/basis/cube_haar.h"
#include "core/light/cube_light.h"
#include "core/relight/held_light.h"
#include "core/relight/update_plan.h"
#include "core/transport/receivers.h"
#include "core/transport/transport.h"

namespace rimlight {

/// What an image is held as. By band: an image B_i for each band of the light, so that each may
/// start from zero by itself; B = Σ B_i in band order (Overbeck 2006, figure 6.1, line 20).
/// Together: B alone, and bands start from zero together or not at all. It takes a fraction of the
/// memory, and of the time to move it.
enum class HeldImages : std::uint8_t { by_band, together };

/// Holds an image and the light that it shows. Images are held as transport is stored: pixel Haar
/// coefficients before reflectance (receiver_planes.h).
///
/// The same calls give the same bits at any thread count: a tile is one thread's, columns are added
/// in the plan's order. exact() gives bits that depend on the target alone.
/// Allocates nothing after the first frames. One thread at a time; computes on all cores. The
/// transport must outlive it.
class Relighter {
 public:
  /// A black image under a black light. `reflectance` is the transport's, and outlives it too.
  /// Memory: 2 · images · tiles · 48 KiB.
  Relighter(const TransportView& transport, const ReceiverValues& reflectance,
            const CubeHaar& basis, HeldImages images = HeldImages::by_band);

  /// Whether each band has an image of its own.
  bool holds_bands() const { return holds_bands_; }

  /// The light that the image shows, L̃: coefficients, by layers of transport.
  HeldLight held() const { return held_; }

  /// Applies a plan made for `target` and held(): resets bands, adds columns, moves held(). And
  /// rebuilds some tiles afresh from what is held, so that rounding never shows: each addition
  /// rounds a sum by at most 2⁻²⁴ of it, one way or the other, so that n of them leave a relative
  /// error of about √(n/3) · 2⁻²⁴, 9.7e-6 for kMostAdditions; each tile is rebuilt about once in so
  /// many. Columns are counted by the layer that is added most often: a number lies in the same
  /// layer of most columns. CheckFailure when the plan resets some bands of an image that holds
  /// them together.
  void apply(const UpdatePlan& plan, const CubeLight& target);

  /// The exact image: one fresh product with every column whose target is not zero, in ascending
  /// order, band by band, whatever the image is held as; then held() is the target. `abandon` (may
  /// be empty) is asked before each tile, from several threads at once; when it answers true,
  /// nothing has changed and false comes back.
  [[nodiscard]] bool apply_exact(const CubeLight& target, const std::function<bool()>& abandon);

  /// Columns that the last apply() or apply_exact() added.
  std::size_t last_terms() const { return last_terms_; }
  /// Tiles that the last apply() rebuilt.
  std::size_t tiles_rebuilt() const { return tiles_rebuilt_; }

  static constexpr std::size_t kMostAdditions = 80'000;

  std::size_t tile_count() const { return transport_.tile_count(); }
  /// One tile of B: radiance [block][3][8]. Any thread.
  void find_radiance(std::size_t tile, std::span<float, kTileFloats> radiance) const;
  /// Whether a band's image (or the one of all) is zero everywhere, because nothing was added since
  /// its reset.
  bool is_zero(int band) const { return zero_[holds_bands_ ? static_cast<std::size_t>(band) : 0]; }

 private:
  /// Zeroes reset bands of `images` in one tile, and those that are to count as zero, and adds the
  /// columns.
  void update_tile(const UpdatePlan& plan, const std::vector<bool>& is_zero, std::size_t tile,
                   std::vector<ReceiverValues>& images) const;
  /// The plan's columns in one tile of the image of all bands: the bits of Σ B_i.
  void sum_fresh_bands(std::size_t tile, float* image) const;
  void sum_bands(std::size_t tile, std::span<float, kTileFloats> held) const;
  void check_resets(const UpdatePlan& plan) const;
  void move_held(const UpdatePlan& plan, const CubeLight& target);
  void plan_afresh(const HeldLight& light);
  /// How many are due when the plan is added; and how, from the held light.
  void choose_rebuilt_tiles(const UpdatePlan& plan);

  TransportView transport_;
  const ReceiverValues& reflectance_;
  CubeHaar basis_;
  std::array<CubeLight, kLayers> held_;
  bool holds_bands_;
  std::vector<ReceiverValues> images_;  // [band], or one
  std::vector<bool> zero_;              // [image]: it counts as zero, whatever it holds
  std::vector<bool> was_zero_;          // before the update
  std::vector<ReceiverValues> fresh_;   // where the exact product grows until it is whole
  UpdatePlan fresh_plan_;
  std::size_t last_terms_ = 0;
  std::size_t tiles_rebuilt_ = 0;
  std::size_t next_rebuilt_ = 0;    // tile, in turn
  std::size_t rebuild_credit_ = 0;  // tiles · columns added since a tile was rebuilt
};

}  // namespace rimlight
