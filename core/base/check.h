#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

namespace rimlight {

/// A broken invariant of our own code: a bug, never bad input.
class CheckFailure : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

namespace detail {
[[noreturn]] void fail_check(const char* file, int line, const std::string& message);

template <typename A, typename B>
[[noreturn]] void fail_comparison(const char* file, int line, const char* text, const A& a,
                                  const B& b) {
  std::ostringstream message;
  message << text << " with " << a << " and " << b;
  fail_check(file, line, message.str());
}
}  // namespace detail

}  // namespace rimlight

/// RIMLIGHT_CHECK(condition): throws CheckFailure naming the condition; on in release, at cold
/// places.
#define RIMLIGHT_CHECK(condition)                                     \
  do {                                                                \
    if (!(condition)) [[unlikely]]                                    \
      ::rimlight::detail::fail_check(__FILE__, __LINE__, #condition); \
  } while (false)

/// RIMLIGHT_CHECK_EQ(a, b): as RIMLIGHT_CHECK(a == b), and prints both values.
#define RIMLIGHT_CHECK_EQ(a, b)                                                             \
  do {                                                                                      \
    if (const auto& check_a_ = (a); !(check_a_ == (b))) [[unlikely]]                        \
      ::rimlight::detail::fail_comparison(__FILE__, __LINE__, #a " == " #b, check_a_, (b)); \
  } while (false)
