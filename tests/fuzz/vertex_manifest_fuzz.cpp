// The manifest of a bake of vertices: what is understood is written and understood again.

#include <cstdlib>

#include "core/transport/vertex_bake_manifest.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rimlight;
  return fuzz::expect_result_or_error([&] {
    const nlohmann::json document = parse_json(fuzz::text_of(data, size), "input");
    const JsonReader reader(document, "input");
    nlohmann::json once = to_json(read_vertex_manifest(reader), read_vertex_shape(reader));
    const JsonReader again(once, "again");
    if (to_json(read_vertex_manifest(again), read_vertex_shape(again)) != once) std::abort();
  });
}
