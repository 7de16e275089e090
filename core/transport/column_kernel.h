#pragma once

#include <span>

#include "core/math/vec.h"
#include "core/transport/transport.h"

namespace rimlight {

/// One column of an update: T_c += delta_c · M[column] per channel (receiver_planes.h has T).
struct ColumnDelta {
  std::uint32_t column = 0;
  Vec3f delta;
};

/// Adds columns' runs of one tile to what that tile holds, in the order given:
///   held  [kTileFloats] = [block][3][8], pixel Haar coefficients of T; 64-byte aligned
/// Dispatched once a call to the widest SIMD target (Highway); fp32 accumulation with FMA where the
/// target has it. Bound: each addition rounds a few times, relative 2⁻²² of |delta·m| + |held|.
/// The same bits for the same binary and target whatever the thread count. Allocates nothing.
void add_columns(const TransportView& transport, std::size_t tile,
                 std::span<const ColumnDelta> columns, float* held) noexcept;

/// The SIMD target in use, as inspect and the server's log name it ("AVX2", …).
const char* column_kernel_target();

}  // namespace rimlight
