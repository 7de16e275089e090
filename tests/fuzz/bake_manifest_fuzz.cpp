// The manifest of a bake of pixels, with curves or without: what is understood is written and
// understood again.

#include <cstdlib>

#include "core/transport/bake_manifest.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

/// Beside what BakeManifest holds.
nlohmann::json understood(const nlohmann::json& document) {
  using namespace rimlight;
  nlohmann::json result = manifest_to_json(read_manifest(JsonReader(document, "input")));
  result["environments"] = nlohmann::json::array();
  result["files"] = nlohmann::json::object();
  return result;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rimlight;
  return fuzz::expect_result_or_error([&] {
    const nlohmann::json once = understood(parse_json(fuzz::text_of(data, size), "input"));
    if (understood(once) != once) std::abort();
  });
}
