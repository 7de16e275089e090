#include "server/protocol/display_message.h"

#include <string>

namespace rimlight::server {
namespace {

constexpr std::size_t kMostCodecs = 16;
constexpr std::int64_t kLargestPixels = std::int64_t{1} << 40;

}  // namespace

Display read_display(const JsonReader& message) {
  message.allow_only({"type", "codecs", "parts", "hidden", "most_pixels"});
  Display display;
  for (const JsonReader& codec : message.member("codecs").elements(0, kMostCodecs)) {
    if (codec.string() == "vp8") display.vp8 = true;
  }
  if (const auto parts = message.optional_member("parts")) display.parts = parts->boolean();
  if (const auto hidden = message.optional_member("hidden")) display.hidden = hidden->boolean();
  if (const auto most = message.optional_member("most_pixels")) {
    display.most_pixels = most->integer(1, kLargestPixels);
  }
  return display;
}

}  // namespace rimlight::server
