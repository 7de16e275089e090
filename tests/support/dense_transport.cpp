#include "tests/support/dense_transport.h"

#include <algorithm>

#include "core/basis/cube_haar.h"
#include "core/transport/column_kernel.h"
#include "core/transport/receiver_planes.h"

namespace rimlight::test {
namespace {

/// Columns of one tile as radiance: [column], each of one tile.
std::vector<ReceiverValues> decode_tile(const Bake& bake, std::size_t tile) {
  std::vector<ReceiverValues> columns;
  for (std::uint32_t column = 0; column < bake.transport().column_count(); ++column) {
    ReceiverValues& values = columns.emplace_back(1);
    const std::vector<ColumnDelta> one = {{column, {1, 1, 1}}};
    add_columns(bake.transport(), tile, one, values.tile(0));
    restore_radiance(values.tile_span(0), bake.reflectance().tile_span(tile));
  }
  return columns;
}

}  // namespace

std::vector<float> dense_transport(const Bake& bake) {
  const PixelLayout& pixels = bake.manifest().pixels;
  const CubeHaar haar(bake.manifest().cube_size);
  const std::size_t count = haar.coefficient_count();
  AlignedVector<float> coefficients(count), texels(count);
  std::vector<float> matrix(static_cast<std::size_t>(pixels.width) *
                            static_cast<std::size_t>(pixels.height) * count * 3);
  for (std::size_t tile = 0; tile < pixels.tile_count(); ++tile) {
    const auto columns = decode_tile(bake, tile);
    for (std::size_t i = 0; i < kTileReceivers; ++i) {
      const auto [x, y] = pixels.pixel(tile * kTileReceivers + i);
      if (x >= pixels.width || y >= pixels.height) continue;
      float* const row = matrix.data() + static_cast<std::size_t>(y * pixels.width + x) * count * 3;
      for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t j = 0; j < count; ++j) {
          coefficients[j] = columns[j].at(i)[static_cast<int>(c)];
        }
        haar.inverse(coefficients, texels);
        for (std::size_t t = 0; t < count; ++t) row[3 * t + c] = texels[t];
      }
    }
  }
  return matrix;
}

}  // namespace rimlight::test
