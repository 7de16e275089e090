#pragma once

#include <string>
#include <utility>

#include "core/base/error.h"

namespace rimlight::test {

/// What the Error that `action` throws says; "no error" when it throws none. Other exceptions pass.
template <typename Action>
std::string error_of(Action&& action) {
  try {
    std::forward<Action>(action)();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace rimlight::test
