#include "tests/support/dense_transport.h"

#include "core/base/half.h"
#include "core/basis/cube_haar.h"

namespace rimlight::test {
namespace {

/// Haar coefficients of one receiver's channel.
void read_coefficients(const TransportView& transport, std::size_t receiver, std::size_t channel,
                       AlignedVector<float>& coefficients) {
  const std::size_t tile = receiver / kTileReceivers;
  const std::size_t block = receiver % kTileReceivers / kBlockReceivers;
  for (std::size_t column = 0; column < transport.column_count(); ++column) {
    const ColumnRun run = transport.run(tile, column);
    coefficients[column] = 0;
    for (std::size_t i = 0; i < run.block_index.size(); ++i) {
      if (run.block_index[i] != block) continue;
      const std::size_t at =
          i * kBlockFloats + channel * kBlockReceivers + receiver % kBlockReceivers;
      coefficients[column] = to_float(run.values[at]) * run.scale;
    }
  }
}

}  // namespace

std::vector<float> dense_transport(const Bake& bake) {
  const PixelLayout& pixels = bake.manifest().pixels;
  const CubeHaar haar(bake.manifest().cube_size);
  AlignedVector<float> coefficients(haar.coefficient_count()), texels(haar.coefficient_count());
  std::vector<float> matrix(static_cast<std::size_t>(pixels.width) *
                            static_cast<std::size_t>(pixels.height) * texels.size() * 3);
  float* row = matrix.data();
  for (int y = 0; y < pixels.height; ++y) {
    for (int x = 0; x < pixels.width; ++x, row += 3 * texels.size()) {
      for (std::size_t c = 0; c < 3; ++c) {
        read_coefficients(bake.transport(), pixels.receiver(x, y), c, coefficients);
        haar.inverse(coefficients, texels);
        for (std::size_t t = 0; t < texels.size(); ++t) row[3 * t + c] = texels[t];
      }
    }
  }
  return matrix;
}

}  // namespace rimlight::test
