#pragma once

namespace rimlight {

/// Additions and multiplications a second of one thread in fp32, when nothing but multiply-adds on
/// registers of the widest SIMD target runs: the best of some runs of about a millisecond.
double peak_flops();

}  // namespace rimlight
