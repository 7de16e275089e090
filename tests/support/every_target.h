#pragma once

#include <gtest/gtest.h>

#include <hwy/targets.h>
#include <cstdint>

namespace rimlight::test {

/// Runs a check under every SIMD target that this machine has; returns how many there are.
template <typename Check>
int for_every_target(const Check& check) {
  int targets = 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    check();
    ++targets;
  }
  hwy::SetSupportedTargetsForTest(0);
  return targets;
}

}  // namespace rimlight::test
