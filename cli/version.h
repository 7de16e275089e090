#pragma once

#include <string>

namespace rimlight {

/// The program's version, and what it is built without.
std::string version();
/// The commit that it was built from, "+" behind it where files differed; empty outside a checkout.
std::string source_commit();

}  // namespace rimlight
