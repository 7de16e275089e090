#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/basis/cube_haar.h"
#include "core/light/cube_light.h"
#include "core/relight/policy.h"

namespace rimlight::test {

/// How a random planning problem is made.
struct PolicyCaseSettings {
  int size = 8;  // texels a side
  std::uint64_t seed = 1;
  /// Values are multiples of it (and norms of squares of multiples of 1/4), so that sums of their
  /// products are exact in double, and equals are equal; 0: any values, without ties.
  float quantum = 1.0f / 16;
  double zero_share = 0.2;                // of coefficients that are zero
  std::size_t active_columns = SIZE_MAX;  // others have neither light nor norm
};

/// A random planning problem: each band's held light is anywhere from the target to far off.
struct PolicyCase {
  CubeHaar haar;
  CubeLight target, held;
  std::vector<float> norm_squared;   // [3][columns]
  std::vector<std::uint32_t> bytes;  // [columns], 1 to 40
  std::size_t image_bytes = 60;

  explicit PolicyCase(const PolicyCaseSettings& settings);

  /// Columns [begin, end) get norm zero.
  void leave_unseen(std::size_t begin, std::size_t end);

  PlanRequest request(Budget budget) const {
    return {haar, target, held, budget, norm_squared, bytes, image_bytes};
  }
};

/// A plan in fresh storage.
UpdatePlan plan_of(const UpdatePolicy& policy, const PlanRequest& request);
/// By the policy's name.
UpdatePlan plan_of(const char* policy, const PlanRequest& request);

/// Every policy there is, by name, all band tests and selections included.
std::vector<std::string> every_policy();

/// What an image's held light becomes under a plan, without an image.
void apply(const UpdatePlan& plan, const CubeHaar& haar, const CubeLight& target, CubeLight& held);

}  // namespace rimlight::test
