#pragma once

#include <span>
#include <vector>

#include "core/base/half.h"
#include "core/basis/sh.h"
#include "core/basis/sh_tripling.h"
#include "core/math/vec.h"
#include "core/transport/vertex_transport.h"

// The light of one vertex in double, as dull as possible.
namespace rimlight::reference {

/// (n + 1)² of one vertex' row of transport, in double.
inline std::vector<double> row_of(std::span<const Half> transport, std::size_t block,
                                  std::size_t count, std::size_t lane) {
  std::vector<double> row(count);
  for (std::size_t i = 0; i < count; ++i) {
    row[i] = static_cast<double>(to_float(transport[(block * count + i) * kBatchVertices + lane]));
  }
  return row;
}

/// Σ_j Σ_k C(i, j, k) f_j L_k to the degree of f, one channel of a light of any degree.
inline std::vector<double> product(const std::vector<double>& f, std::span<const float> light) {
  std::vector<double> result(f.size());
  const int degree = sh::degree_of_count(f.size());
  ShTripling::to_degree(degree).for_each(
      [&](std::size_t i, std::size_t j, std::size_t k, double c) {
        if (k >= light.size()) return;
        result[i] += c * f[j] * static_cast<double>(light[k]);
        if (i != j) result[j] += c * f[i] * static_cast<double>(light[k]);
      });
  return result;
}

inline double highlight(const std::vector<double>& incident, std::span<const float> factors,
                        const Vec3f& mirrored) {
  const int degree = sh::degree_of_count(incident.size());
  const auto values = sh::evaluate(
      normalized(Vec3d{static_cast<double>(mirrored.x), static_cast<double>(mirrored.y),
                       static_cast<double>(mirrored.z)}),
      degree);
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += static_cast<double>(factors[static_cast<std::size_t>(sh::degree_of(i))]) * values[i] *
           incident[i];
  }
  return sum;
}

}  // namespace rimlight::reference
