#include "server/network/readiness.h"

#include <nlohmann/json.hpp>

namespace rimlight::server {

std::string write_readiness(const std::vector<std::string>& reasons) {
  nlohmann::json body{{"ready", reasons.empty()}};
  if (!reasons.empty()) body["reasons"] = reasons;
  return body.dump() + "\n";
}

}  // namespace rimlight::server
