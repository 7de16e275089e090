#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/aligned_vector.h"
#include "core/transport/vertex_transport.h"

namespace rimlight {

/// Transport as it was calculated, to one degree n.
struct CalculatedTransport {
  std::size_t vertex_count = 0;
  std::size_t highlight_count = 0;
  int degree = 0;
  bool is_open = false;  // irradiance follows from the normals: nothing shadows or reflects it
  std::vector<std::vector<float>> irradiance;  // 1 or 3 channels: [vertex][(n + 1)²]
  std::vector<float> visibility;               // [highlight vertex][(n + 1)²]
};

/// What is left out of storage.
struct LeavingOut {
  /// What bands of the highest degrees, or differences between channels, may cost: what they hold
  /// at a vertex (and channel), as an L2 norm over the sphere, root mean square over these, as a
  /// share of the norm of what is not shadowed: √(2π/3), of the clamped cosine, for irradiance,
  /// √(2π), of the hemisphere, for visibility.
  double error = 0.01;
  bool keep_bands = false;
};

struct StoredTransport {
  VertexTransportView view;  // of the vectors below
  AlignedVector<Half> irradiance, visibility;
  nlohmann::json left_out;  // for the manifest: what, and what that costs
};

/// Transport as bakes store it: in batches of halves; in one channel where three are the same; and
/// none at all of irradiance that is open; and
/// without the highest bands, as long as what is left out of irradiance, and of visibility, costs
/// no more than the error.
StoredTransport pack(const CalculatedTransport& transport, const LeavingOut& leaving_out);

}  // namespace rimlight
