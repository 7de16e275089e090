// A build without libvpx: says so.

#include "core/base/error.h"
#include "core/image/vp8_codec.h"

namespace rimlight {
namespace {

[[noreturn]] void refuse() { throw Error("VP8", "a build without it", "RIMLIGHT_VP8=ON"); }

}  // namespace

class Vp8Encoder::State {};
class Vp8Decoder::State {};

bool has_vp8() { return false; }

Vp8Encoder::Vp8Encoder(int, int, int) { refuse(); }
Vp8Encoder::~Vp8Encoder() = default;
void Vp8Encoder::encode(const Rgb8Image&, const Vp8Links&, std::vector<std::uint8_t>&) { refuse(); }

Vp8Decoder::Vp8Decoder() { refuse(); }
Vp8Decoder::~Vp8Decoder() = default;
void Vp8Decoder::decode(std::span<const std::uint8_t>, std::string_view, Rgb8Image&) { refuse(); }

}  // namespace rimlight
