#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "core/import/direction_list.h"

namespace rimlight {

/// Whether a comes before b when numbers in names count as numbers: light_2 before light_10.
bool comes_before(std::string_view a, std::string_view b);

/// The pictures of a list of directions, one each, in its order. `inputs` is either one folder,
/// where the list's names lie (or, if the list has none, every .exr and .png in it by
/// comes_before, but `mask`), or the pictures themselves, for a list without names. Throws Error:
/// a folder that cannot be read, a list with names beside pictures, more or fewer pictures than
/// directions.
std::vector<std::filesystem::path> find_pictures(const std::vector<std::filesystem::path>& inputs,
                                                 const DirectionList& list,
                                                 const std::filesystem::path& mask = {});

}  // namespace rimlight
