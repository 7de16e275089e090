#pragma once

#include <cstdint>

#include "core/base/json_reader.h"

namespace rimlight::server {

/// What one client can show: its `display` message, each of which replaces the one before. The
/// default is that of a client which never says.
struct Display {
  bool vp8 = false;              // besides JPEG and PNG, which all can
  bool parts = false;            // takes a lossless frame in parts
  bool hidden = false;           // wants no frames
  std::int64_t most_pixels = 0;  // of a frame in motion; 0: any

  friend bool operator==(const Display&, const Display&) = default;
};

/// Reads the message. Throws Error, naming the field; a codec of a name that is not known is
/// passed over, so that clients may offer what later servers have.
Display read_display(const JsonReader& message);

}  // namespace rimlight::server
