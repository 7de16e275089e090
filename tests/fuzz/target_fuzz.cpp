// The target of a request line, as a stream's, an upload's and a file's: what is taken is sound.

#include <cstdlib>

#include "server/protocol/query_string.h"
#include "server/protocol/stream_target.h"
#include "server/protocol/upload_target.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rimlight;
  const std::string_view target = fuzz::text_of(data, size);
  fuzz::expect_result_or_error([&] {
    const server::StreamTarget stream = server::parse_stream_target(target);
    if (!server::is_valid_name(stream.session)) std::abort();
    if (!stream.scene.empty() && !server::is_valid_name(stream.scene)) std::abort();
  });
  fuzz::expect_result_or_error([&] {
    const server::UploadTarget upload = server::parse_upload_target(target);
    if (!server::is_upload_target(target)) std::abort();
    if (!server::is_valid_name(upload.session) || !server::is_valid_name(upload.environment)) {
      std::abort();
    }
  });
  return fuzz::expect_result_or_error([&] {
    server::parse_query(target, {"scene", "material", "measured"});
  });
}
