#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/report/table.h"

namespace rimlight {

/// What one experiment found, for a person: a part of a page.
struct ReportSection {
  std::string title = {};
  std::string question = {};  // what the experiment asks, in a sentence or two
  std::vector<std::string> remarks = {};
  std::vector<Table> tables = {};
  std::vector<std::filesystem::path> pictures = {};  // .png
};

/// A page that needs nothing beside itself: style and pictures stand in it. `facts` are pairs of a
/// name and a text for its head: the machine, the version, the command. Throws Error when a picture
/// cannot be read, or is larger than 16 MiB.
std::string to_html(const std::string& title,
                    const std::vector<std::pair<std::string, std::string>>& facts,
                    const std::vector<ReportSection>& sections);

/// With &, <, > and " written so that they are text.
std::string escape_html(const std::string& text);

}  // namespace rimlight
