#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace rimlight::server {

// A client's way back to its place in a session, after a lost link or a restart of the server: who
// has it is taken for the same user. It opens nothing by itself: the access token does that.

/// Digits in base 16, of 256 bits.
constexpr std::size_t kResumeTokenDigits = 64;

bool is_resume_token(std::string_view text);
/// From the system's generator. Throws Error when that fails.
std::string make_resume_token();
/// SHA-256, in base 16: all that is kept of a token.
std::string resume_token_hash(std::string_view token);

}  // namespace rimlight::server
