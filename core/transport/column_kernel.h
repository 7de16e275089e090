#pragma once

#include <span>

#include "core/math/vec.h"
#include "core/transport/transport.h"

namespace rimlight {

/// One column of an update: radiance += delta · M[column], per channel.
struct ColumnDelta {
  std::uint32_t column = 0;
  Vec3f delta;
};

/// Adds columns' runs of one tile to that tile's radiance, in the order given:
///   tile_radiance  [kTileFloats] = [block][3][8], 64-byte aligned
/// Dispatched once a call to the widest SIMD target (Highway); fp32 accumulation with FMA where the
/// target has it. Bound: each addition rounds once, relative 2⁻²³ of |delta·m| + |B|.
/// The same bits for the same binary and target whatever the thread count. Allocates nothing.
void add_columns(const TransportView& transport, std::size_t tile,
                 std::span<const ColumnDelta> columns, float* tile_radiance) noexcept;

/// The SIMD target in use, as inspect and the server's log name it ("AVX2", …).
const char* column_kernel_target();

}  // namespace rimlight
