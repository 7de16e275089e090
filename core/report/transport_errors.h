#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/light/cube_light.h"
#include "core/transport/bake_folder.h"
#include "core/transport/reference_rows.h"

namespace rimlight {

/// What is wrong with an image before anything is left out of its transport: relative to the norm
/// of the image on the receivers that it is measured on. Nothing where the bake cannot tell.
struct TransportError {
  /// Monte Carlo noise of M. Two traces with different seeds differ by √2 of it.
  std::optional<double> noise;
  /// What N's texels average away, as far as a cube map of twice the size sees it: the finest band
  /// of the light there through the finest band of M there. M's noise in that band counts too; what
  /// is finer still does not.
  std::optional<double> resolution;
};

/// Measures them on the reference rows that a bake has twice. One thread at a time; computes on all
/// cores.
class TransportErrors {
 public:
  /// Throws Error when rows do not fit each other. The bake outlives it.
  explicit TransportErrors(const Bake& bake);

  /// The size of cube map that find() wants a light on as well; 0 when it needs none.
  int finer_size() const { return finer_size_; }

  /// For each light, as coefficients of N; and of finer_size(), where that is not 0.
  std::vector<TransportError> find(std::span<const CubeLight> lights,
                                   std::span<const CubeLight> finer_lights) const;

 private:
  std::optional<ReferenceRows> rows_, retraced_, finer_;
  std::vector<std::size_t> place_;  // of each checked group, among those of rows_
  int finer_size_ = 0;
};

}  // namespace rimlight
