#pragma once

#include <vector>

#include "core/basis/sh_zonal.h"
#include "core/math/random.h"
#include "core/vertices/vertex_products.h"

namespace rimlight::test {

/// Transport of random numbers, falling from band to band as real ones do, that owns its memory.
struct RandomVertices {
  struct Shape {
    std::size_t vertices = 200;
    std::size_t highlights = 200;
    int irradiance_degree = 4;
    int visibility_degree = 4;
    std::size_t channels = 1;
  };

  explicit RandomVertices(const Shape& shape, std::uint64_t seed = 7) : shape_(shape) {
    Random random(seed);
    fill(batch_count(shape.vertices) * shape.channels, shape.irradiance_degree, random,
         irradiance_);
    fill(batch_count(shape.highlights), shape.visibility_degree, random, visibility_);
    for (std::size_t v = 0; v < shape.vertices; ++v) {
      mirrored.push_back({static_cast<float>(random.uniform(-1, 1)),
                          static_cast<float>(random.uniform(-1, 1)),
                          static_cast<float>(random.uniform(0.1, 1))});
      lobe_of.push_back(v % 3 == 0 ? 1u : 0u);
    }
    for (const double exponent : {8.0, 50.0}) {
      const auto factors = convolution_factors(sh::phong_lobe(exponent, shape.visibility_degree));
      lobes.insert(lobes.end(), factors.begin(), factors.end());
    }
  }

  VertexTransportView view() const {
    return {shape_.vertices,
            shape_.highlights,
            shape_.irradiance_degree,
            shape_.visibility_degree,
            shape_.channels,
            irradiance_,
            visibility_};
  }
  VertexGloss gloss() const { return {mirrored, lobes, lobe_of}; }

  /// [3][(degree + 1)²]
  static std::vector<float> light(int degree, std::uint64_t seed = 3) {
    Random random(seed);
    std::vector<float> values(kLightChannels * sh::coefficient_count(degree));
    for (float& value : values) value = static_cast<float>(random.uniform(-1, 1));
    return values;
  }

  std::vector<Vec3f> mirrored;
  std::vector<float> lobes;
  std::vector<std::uint32_t> lobe_of;

 private:
  static void fill(std::size_t blocks, int degree, Random& random, AlignedVector<Half>& to) {
    const std::size_t count = sh::coefficient_count(degree);
    to.resize(blocks * count * kBatchVertices);
    for (std::size_t i = 0; i < to.size(); ++i) {
      const auto l = static_cast<double>(sh::degree_of(i / kBatchVertices % count));
      to[i] = to_half(static_cast<float>(random.uniform(-1, 1) / (1 + l)));
    }
  }

  Shape shape_;
  AlignedVector<Half> irradiance_, visibility_;
};

}  // namespace rimlight::test
