#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/math/vec.h"
#include "core/transport/transport.h"

namespace rimlight {

/// One column of an update, or some layers of it: T_c += delta_c · M[column] per channel
/// (receiver_planes.h has T).
struct ColumnDelta {
  std::uint32_t column = 0;
  Vec3f delta;
  LayerSet layers = kAllLayers;
};

/// Adds columns' runs of one tile to what that tile holds, in the order given:
///   held  [kTileFloats] = [block][3][8], pixel Haar coefficients of T; 64-byte aligned
/// Dispatched once a call to the widest SIMD target (Highway); fp32 accumulation with FMA where the
/// target has it. Bound: each addition rounds a few times, relative 2⁻²² of |delta·m| + |held|.
/// The same bits for the same binary and target whatever the thread count. Allocates nothing.
void add_columns(const TransportView& transport, std::size_t tile,
                 std::span<const ColumnDelta> columns, float* held) noexcept;

/// One update for several sessions: the columns of all, and what each session adds of them.
struct SessionDeltas {
  std::span<const std::uint32_t> columns;
  std::span<const Vec3f> deltas;  // [column][session]
};

/// add_columns() for several sessions that hold an image of the same transport: each block of M is
/// read from memory once for all, and decoded once for every two. `held`: a tile for each session,
/// no two the same; CheckFailure when there is not a delta for each column and session. A tile gets
/// the same bits as from add_columns() with the session's own deltas for all of these columns; a
/// zero delta is added like any other.
void add_columns_to_all(const TransportView& transport, std::size_t tile,
                        const SessionDeltas& columns, std::span<float* const> held);

/// The SIMD target in use, as inspect and the server's log name it ("AVX2", …).
const char* column_kernel_target();

}  // namespace rimlight
