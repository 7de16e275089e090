#pragma once

#include <cstddef>
#include <span>

namespace rimlight::sh {

/// The values of the basis at a block of directions, as sh::evaluate() leaves them, and as many
/// values of several signals there. `directions` is a multiple of kDirectionLanes and at most
/// `stride`; everything is 64-byte aligned.
struct BasisBlock {
  const float* values = nullptr;  // [coefficients][stride]
  std::size_t coefficients = 0;
  std::size_t directions = 0;
  std::size_t stride = 0;
};

/// sums[signal][coefficient] += Σ values[coefficient][d] · samples[signal][d]; samples [signals]
/// [stride]. Within a block in float, from block to block in double.
void add_projection(const BasisBlock& block, const float* samples, std::size_t signals,
                    double* sums) noexcept;

/// samples[signal][d] = Σ coefficients[signal][coefficient] · values[coefficient][d], in float.
void sum_basis(const BasisBlock& block, const float* coefficients, std::size_t signals,
               float* samples) noexcept;

}  // namespace rimlight::sh
