#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/relight/policy.h"
#include "core/relight/policy_settings.h"

namespace rimlight {

/// The two ways to treat a band (Overbeck 2006, §6.2): a column's delta is target − held, or the
/// target itself.
enum class Alternative : std::uint8_t { increment, reset };

/// What a policy chooses from: whole columns, or their layers by themselves (parts). Both are
/// numbered in order of columns, so that a band is one range of them. Here "column" also stands for
/// a part, where a policy chooses those.
class Candidates {
 public:
  static Candidates columns(const CubeHaar& basis) { return {basis, 1}; }
  static Candidates parts(const CubeHaar& basis) { return {basis, kLayers}; }

  bool are_parts() const { return per_column_ > 1; }
  std::size_t count() const { return per_column_ * basis_->coefficient_count(); }
  int band_count() const { return basis_->band_count(); }
  std::size_t band_begin(int band) const { return per_column_ * basis_->band_begin(band); }
  std::size_t column_of(std::size_t candidate) const { return candidate / per_column_; }
  LayerSet layers_of(std::size_t candidate) const {
    return are_parts() ? static_cast<LayerSet>(1 << candidate % per_column_) : kAllLayers;
  }

 private:
  Candidates(const CubeHaar& basis, std::size_t per_column)
      : basis_(&basis), per_column_(per_column) {}

  const CubeHaar* basis_;
  std::size_t per_column_;
};

/// What a budget counts: one for each column, or its bytes (at least one).
class ColumnCosts {
 public:
  ColumnCosts(const PlanRequest& request, const Candidates& candidates)
      : bytes_(request.budget.unit != Budget::Unit::bytes ? nullptr
               : candidates.are_parts()                   ? request.part_bytes.data()
                                                          : request.column_bytes.data()),
        budget_(request.budget.amount) {}

  std::uint64_t budget() const { return budget_; }
  bool are_bytes() const { return bytes_ != nullptr; }
  std::uint64_t of(std::size_t column) const { return are_bytes() ? bytes_of(column) : 1; }
  /// When they are bytes.
  std::uint32_t bytes_of(std::size_t column) const {
    return bytes_[column] + (bytes_[column] == 0);
  }

 private:
  const std::uint32_t* bytes_;
  std::uint64_t budget_;
};

/// What applying each column takes off the error when its band is treated in one way. The error is
/// the sum of the gains of the columns that are not applied.
struct ColumnGains {
  /// The rank of what changes the light and nothing that is measured: applied after all else.
  static constexpr std::uint32_t kLastRank = 1;

  std::vector<float> gain;  // [columns], finite, ≥ 0
  /// [columns]: the larger goes first; bits of a float, so that integers order as it does. 0: not
  /// to be applied, since its delta is zero, or it costs more than the whole budget.
  std::vector<std::uint32_t> rank;

  /// Σ of gains over a band.
  double of_band(const Candidates& candidates, int band) const;
};

/// Whether every layer's held light is zero all over a band, so that its image is known to be zero.
bool holds_nothing(const PlanRequest& request, int band);

/// Gains of whole columns in the L1 norm: weight of the selection · |delta|, channels summed;
/// ranked as they are. Where layers show several lights, that of the widest counts. By transport,
/// each channel has its own weight, the norm of its column.
void measure_sizes(const PlanRequest& request, Selection selection, Alternative alternative,
                   ColumnGains& gains);

/// Gains in the image's squared error: Σ over channels of (delta · norm)²; ranked per cost. Of
/// whole columns the layers must show one light.
void measure_energies(const PlanRequest& request, const Candidates& candidates,
                      Alternative alternative, ColumnGains& gains);

}  // namespace rimlight
