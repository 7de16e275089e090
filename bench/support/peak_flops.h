#pragma once

namespace rimlight::bench {

/// The most single-precision operations a second of one thread now, an FMA counted as two: the
/// best of some short runs of independent FMAs on the widest SIMD target. Takes some milliseconds.
double peak_flops();

}  // namespace rimlight::bench
