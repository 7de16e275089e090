#pragma once

#include <CLI/CLI.hpp>
#include <charconv>
#include <sstream>
#include <string>

namespace rimlight {

/// A check that an option is a number within [least, most]. CLI::Range lets NaN through.
inline CLI::Validator number_range(double least, double most) {
  std::ostringstream range;
  range << "in [" << least << " - " << most << "]";
  const auto check = [least, most](std::string& text) {
    double number = 0;
    const auto [rest, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_number = fault == std::errc() && rest == text.data() + text.size();
    return is_number && number >= least && number <= most ? std::string()
                                                          : "Value " + text + " not in range";
  };
  return {check, range.str(), "number_range"};
}

}  // namespace rimlight
