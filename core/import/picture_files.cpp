#include "core/import/picture_files.h"

#include <algorithm>
#include <string>

#include "core/base/error.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The leading digits of a text, without leading zeros; both are taken from its front.
std::string_view take_number(std::string_view& text) {
  const auto end = std::find_if_not(text.begin(), text.end(), is_digit);
  std::string_view number = text.substr(0, static_cast<std::size_t>(end - text.begin()));
  text.remove_prefix(number.size());
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

bool is_picture(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return ending == ".exr" || ending == ".png";
}

std::vector<fs::path> pictures_in(const fs::path& folder, const fs::path& mask) {
  std::vector<fs::path> pictures;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code ignored;  // a mask that does not exist is no picture
    if (!is_picture(entry->path()) || fs::equivalent(entry->path(), mask, ignored)) continue;
    pictures.push_back(entry->path());
  }
  if (error) throw Error(folder.string(), error.message(), "a folder that can be read");
  std::sort(pictures.begin(), pictures.end(), [](const fs::path& a, const fs::path& b) {
    return comes_before(a.filename().string(), b.filename().string());
  });
  return pictures;
}

}  // namespace

bool comes_before(std::string_view a, std::string_view b) {
  const std::string_view whole_a = a, whole_b = b;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view number_a = take_number(a), number_b = take_number(b);
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
      continue;
    }
    if (a.front() != b.front()) return a.front() < b.front();
    a.remove_prefix(1);
    b.remove_prefix(1);
  }
  // "a1" and "a01" are different names: some order, always the same.
  return a.empty() && b.empty() ? whole_a < whole_b : a.empty() && !b.empty();
}

std::vector<fs::path> find_pictures(const std::vector<fs::path>& inputs, const DirectionList& list,
                                    const fs::path& mask) {
  const bool is_folder = inputs.size() == 1 && fs::is_directory(inputs.front());
  if (is_folder && !list.images.empty()) {
    std::vector<fs::path> pictures;
    for (const std::string& name : list.images) pictures.push_back(inputs.front() / name);
    return pictures;
  }
  if (!list.images.empty()) {
    throw Error(list.source, "names of images, and images beside them",
                "the folder that the images lie in, or a list without names");
  }
  auto pictures = is_folder ? pictures_in(inputs.front(), mask) : inputs;
  if (pictures.size() != list.size()) {
    throw Error(inputs.front().string() + (inputs.size() > 1 ? ", …" : ""),
                std::to_string(pictures.size()) + " pictures",
                std::to_string(list.size()) + ", one for each direction of " + list.source);
  }
  return pictures;
}

}  // namespace rimlight
