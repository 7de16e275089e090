#include "core/base/check.h"

namespace rimlight::detail {

void fail_check(const char* file, int line, const std::string& message) {
  throw CheckFailure(std::string(file) + ":" + std::to_string(line) + ": check failed: " + message);
}

}  // namespace rimlight::detail
