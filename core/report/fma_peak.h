#pragma once

namespace rimlight {

/// The most single-precision operations a second that all threads (parallel.h) do together now, an
/// FMA counted as two: the best of a few short runs of independent FMAs on the widest SIMD target.
/// About a millisecond: what a kernel reaches is put beside it in the same moment.
double fma_peak();

}  // namespace rimlight
