// What a stranger shows at the door: any text as a token, and any text as the claims and as the
// header of one that is signed well, so that what lies behind the signature is reached too.

#include <cstdlib>

#include "server/access/access_token.h"
#include "server/protocol/stream_target.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/signed_token.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rimlight;
  static const std::string secret(32, 's');
  static const server::SigningKeys keys({{"a", secret}, {"b", std::string(33, 't')}});
  static const server::WallClock::time_point now{std::chrono::seconds(1'800'000'000)};
  const std::string_view text = fuzz::text_of(data, size);
  const auto check = [](const std::string& token) {
    const auto checked = server::check_token(token, keys, now);
    const auto* const access = std::get_if<server::Access>(&checked);
    if (access == nullptr) return;
    const bool is_sound = (access->session == "*" || server::is_valid_name(access->session)) &&
                          access->name.size() <= server::kLongestPersonName &&
                          access->expires > now - std::chrono::hours(1);
    if (!is_sound) std::abort();
  };
  check(std::string(text));
  check(test::signed_token(R"({"alg":"HS256","typ":"JWT","kid":"a"})", text, secret));
  check(test::signed_token(
      text, R"({"role":"editor","session":"*","exp":1800000100,"iat":1800000000})", secret));
  return 0;
}
