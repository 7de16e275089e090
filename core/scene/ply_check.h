#pragma once

#include <filesystem>

namespace rimlight {

/// Checks what a PLY file claims against what it holds, before anything is allocated: the header
/// has an end and known types, and the data after it hold every element, list by list. assimp
/// checks none of it: it does not return from a header without an end, and reads beyond the end of
/// truncated text. Throws Error naming the file, and the header's line or the element.
void check_ply(const std::filesystem::path& path);

}  // namespace rimlight
