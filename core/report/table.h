#pragma once

#include <string>
#include <vector>

namespace rimlight {

/// What a report says in words and numbers: for a terminal and for a page.
struct Table {
  std::string caption = {};
  std::vector<std::string> columns = {};
  std::vector<std::vector<std::string>> rows = {};  // a cell a column
};

/// A number with so many digits after the point; "-" where it is not finite.
std::string fixed(double value, int digits);
/// The same with so many digits that count.
std::string significant(double value, int digits);

/// Whether all cells of a column are numbers, or "-": those stand at the right.
bool is_numeric(const Table& table, std::size_t column);

/// In columns of equal width, a line a row, the caption above. Control characters, which
/// a terminal would obey, become "?". CheckFailure for a row of other length than `columns`.
std::string to_text(const Table& table);

}  // namespace rimlight
