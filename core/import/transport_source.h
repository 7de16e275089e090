#pragma once

#include <cstddef>
#include <span>

#include "core/transport/receivers.h"

namespace rimlight {

/// Where imported transport comes from: the pixels' values under each direction's light, given out
/// as a bake is made, 64 receivers at a time. Immutable; any thread.
class TransportSource {
 public:
  TransportSource() = default;
  TransportSource(const TransportSource&) = delete;
  TransportSource& operator=(const TransportSource&) = delete;
  virtual ~TransportSource() = default;

  virtual PixelLayout pixels() const = 0;
  virtual std::size_t direction_count() const = 0;

  /// The receivers first_receiver … first_receiver + 63, a group of PixelLayout: rows
  /// [direction][channel][64], 64-byte aligned, overwritten. Receivers outside the picture are
  /// black. Finite. Throws Error when the input cannot be read, or is not finite there.
  virtual void read_group(std::size_t first_receiver, std::span<float> rows) const = 0;
};

}  // namespace rimlight
