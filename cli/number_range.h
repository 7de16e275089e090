#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace rimlight {

/// A check that an option is a number within [least, most]. CLI::Range lets NaN through.
inline CLI::Validator number_range(double least, double most) {
  return {[least, most](std::string& text) {
            double number = 0;
            const bool within =
                CLI::detail::lexical_cast(text, number) && number >= least && number <= most;
            return within ? std::string() : "Value " + text + " not in range";
          },
          "in [" + CLI::detail::to_string(least) + " - " + CLI::detail::to_string(most) + "]",
          "number_range"};
}

}  // namespace rimlight
