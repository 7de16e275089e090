#pragma once

#include "cli/serve_layers.h"

namespace rimlight {

/// `rimlight serve --check-config`: opens what the configuration names, as the server would, but
/// listens nowhere; prints every setting, where it comes from, and what was found. 0 when all is
/// well. Throws Error as the server would.
int check_serve(const LayeredConfig& layers, bool as_json);

}  // namespace rimlight
