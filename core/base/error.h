#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace rimlight {

/// Bad input or a bad world: a file, a field of it, the network, the disk.
/// Thrown low, caught only at the edges (subcommand, design-session job, connection).
/// what() reads "WHERE: found FOUND, expected EXPECTED".
class Error : public std::runtime_error {
 public:
  Error(std::string where, std::string found, std::string expected);

  /// File, and field, line or byte where there is one: "scene.json: /objects/2/material".
  const std::string& where() const noexcept { return where_; }
  const std::string& found() const noexcept { return found_; }
  const std::string& expected() const noexcept { return expected_; }

 private:
  std::string where_;
  std::string found_;
  std::string expected_;
};

/// A name from outside in double quotes, safe to print and to send: cut to 80 bytes (between
/// characters), with control characters, quotes and whatever is not UTF-8 escaped.
std::string quote(std::string_view text);

}  // namespace rimlight
