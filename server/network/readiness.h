#pragma once

#include <string>
#include <vector>

namespace rimlight::server {

/// The body of /readyz (docs/protocol/health.md): ready when nothing speaks against it.
std::string write_readiness(const std::vector<std::string>& reasons);

}  // namespace rimlight::server
