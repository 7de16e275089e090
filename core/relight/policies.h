#pragma once

#include "core/relight/column_gains.h"
#include "core/relight/policy.h"
#include "core/relight/policy_settings.h"

namespace rimlight {

/// A fixed basis: every band starts from zero, and the first columns in the basis' order are
/// applied, as many as the budget holds (the linear approximation that the papers compare with).
/// Which columns those are does not depend on the light; the ones that it leaves dark are not
/// replaced by others.
class LinearPolicy final : public UpdatePolicy {
  void plan_checked(const PlanRequest& request, PlanWorkspace::Storage& storage,
                    UpdatePlan& plan) const override;
};

/// Non-incremental wavelet approximation (Ng, Ramamoorthi and Hanrahan 2003): every band starts
/// from zero, and the coefficients of the target that are largest by weight are applied.
class NwaPolicy final : public UpdatePolicy {
 public:
  explicit NwaPolicy(Selection selection = Selection::area) : selection_(selection) {}

 private:
  void plan_checked(const PlanRequest& request, PlanWorkspace::Storage& storage,
                    UpdatePlan& plan) const override;

  Selection selection_;
};

/// Basic incremental (Overbeck 2006, chapter 4): no band is ever reset; of target − held the
/// largest by weight are applied.
///
/// Equation 4.5 adds the approximated difference to the held vector; with ours, held takes the
/// target's value itself, as figure 6.1, line 10 writes it, which is the same without rounding. The
/// paper starts from the whole product and names nwa as the other way: a policy within a budget can
/// only do the latter, and it is what this one does to a light that holds nothing. That first frame
/// counts as a reset. (Start from an exact frame for the former.)
class BiPolicy final : public UpdatePolicy {
 public:
  explicit BiPolicy(Selection selection = Selection::area) : selection_(selection) {}

 private:
  void plan_checked(const PlanRequest& request, PlanWorkspace::Storage& storage,
                    UpdatePlan& plan) const override;

  Selection selection_;
};

/// Per-band incremental (Overbeck 2006, chapter 6): a band is incremented by the largest of
/// target − held, or reset and given the largest of the target, all by weight, over all bands
/// together. The error that the tests compare is the weighted L1 norm of what the light then lacks,
/// in the measure of the selection. A band that holds nothing counts as reset: so the first frame
/// resets all.
///
///   simple      §6.2.2: incremented when ‖target − held‖ < ‖target‖ over the band, or when nothing
///               is wrong with it. The paper's norm has no weight there: within a band, it is the
///               same for area
///   dealer      §6.2.3: columns are dealt out one by one, each to the band whose error falls the
///               most. A band's error with n columns is the smaller of its two alternatives' with
///               their n largest, so that each new column may turn the band over. The paper says no
///               more; ours: of equal falls the coarser band's goes first, of equal alternatives
///               the band is kept. Greedy, since the smaller of two convex curves is not convex
///   exhaustive  §6.2.1: the best of all 2^bands combinations, each with the best columns for it;
///               of equals the cheapest, then the one that keeps the first band where they differ.
///               No other test leaves less error, in this one frame
///
/// The paper calls the last too slow to be practical; with sums along one ranking of all columns it
/// costs little more than the first: bench/core/relight/policy_bench.cpp, docs/results.
class PbiPolicy final : public UpdatePolicy {
 public:
  explicit PbiPolicy(BandTest band_test = BandTest::simple, Selection selection = Selection::area)
      : band_test_(band_test), selection_(selection) {}

 private:
  void plan_checked(const PlanRequest& request, PlanWorkspace::Storage& storage,
                    UpdatePlan& plan) const override;

  BandTest band_test_;
  Selection selection_;
};

/// What lowers the error of the image most for what it costs. The image's expected squared error is
///
///     E = Σ over columns j, channels c of (r_jc · ‖M_jc‖)²        r: target − held after the
///     update
///
/// exact where columns of M are orthogonal, and right on average where the signs of r are random.
/// Applying column j takes its terms out of E: that is its benefit. Within a budget of bytes the
/// layers of a column are columns of their own here (column_run.h): the few wide blocks of many
/// columns mend far more than all blocks of a few. Choosing columns under a budget
/// is a knapsack: in order of benefit per cost, and E is then above the least possible by at most
/// the benefit of the first column that did not fit. No band has a quota.
///
/// What a column costs is what the budget counts: its bytes; or one, and then the order is that of
/// benefit alone.
///
/// Bands compete by the same measure. A band may be incremented; reset, where r starts as the whole
/// target and clearing its image costs band_image_bytes; or cleared, which is a reset without any
/// column: it costs nothing, since an image that is known to be zero is neither written nor read. A
/// band that holds nothing is reset for nothing. All combinations are tried, each with its columns.
/// A budget in coefficients does not count resets, as the papers do not.
///
/// Where the image is one of all bands, there are two combinations: to increment, and to reset all.
///
/// So E is never above that of the better of incrementing and resetting all bands; of equals the
/// cheaper is taken, then that which keeps. Columns of zero norm come last: they change the light
/// that is held, and no pixel.
class BenefitPolicy final : public UpdatePolicy {
  void plan_checked(const PlanRequest& request, PlanWorkspace::Storage& storage,
                    UpdatePlan& plan) const override;
};

}  // namespace rimlight
