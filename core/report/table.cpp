#include "core/report/table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/base/check.h"

namespace rimlight {
namespace {

std::string printed(const char* format, int digits, double value) {
  if (!std::isfinite(value)) return "-";
  char text[64];
  std::snprintf(text, sizeof text, format, digits, value);
  return text;
}

bool is_number(const std::string& cell) {
  if (cell.empty() || cell == "-") return true;
  char* end = nullptr;
  (void)std::strtod(cell.c_str(), &end);
  const std::string unit(end);
  return end != cell.c_str() && (unit.empty() || unit == "%");
}

/// Characters, not bytes: of UTF-8 all that do not go on with one.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
}

}  // namespace

std::string fixed(double value, int digits) { return printed("%.*f", digits, value); }
std::string significant(double value, int digits) { return printed("%.*g", digits, value); }

bool is_numeric(const Table& table, std::size_t column) {
  return std::ranges::all_of(table.rows, [&](const auto& row) { return is_number(row[column]); });
}

std::string to_text(const Table& table) {
  std::vector<std::size_t> widths;
  std::vector<bool> numeric;
  for (const auto& row : table.rows) RIMLIGHT_CHECK(row.size() == table.columns.size());
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    numeric.push_back(is_numeric(table, i));
    widths.push_back(width_of(table.columns[i]));
    for (const auto& row : table.rows) widths[i] = std::max(widths[i], width_of(row[i]));
  }
  std::string text = table.caption.empty() ? "" : table.caption + "\n";
  const auto add = [&](const std::vector<std::string>& cells) {
    std::string line;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string space(widths[i] - width_of(cells[i]), ' ');
      if (i > 0) line += "  ";
      line += numeric[i] ? space + cells[i] : cells[i] + space;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    std::ranges::replace_if(
        line, [](char c) { return c >= 0 && c < ' '; }, '?');
    text += line + "\n";
  };
  add(table.columns);
  for (const auto& row : table.rows) add(row);
  return text;
}

}  // namespace rimlight
