#pragma once

#include <cstddef>

namespace rimlight::test {

/// How often the calling thread has called operator new so far, in a binary that links
/// allocation_count.cpp.
std::size_t allocation_count();

}  // namespace rimlight::test
