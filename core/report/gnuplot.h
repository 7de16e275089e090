#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace rimlight {

/// Runs gnuplot on a script in the script's folder, and waits for it. False when there is none.
/// Throws Error when it fails.
[[nodiscard]] bool run_gnuplot(const std::filesystem::path& script);

/// A gnuplot script that draws one picture, with its data in it.
class GnuplotScript {
 public:
  /// `picture` is the .png file that it writes, beside itself.
  explicit GnuplotScript(const std::string& picture, int width = 1000, int height = 650);

  /// A line of gnuplot.
  void add(const std::string& line);
  /// A block of data, by its name "$NAME" in later lines: rows of numbers.
  void add_data(const std::string& name, const std::vector<std::vector<double>>& rows);
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

struct Figures {
  std::vector<std::filesystem::path> scripts;   // .gp
  std::vector<std::filesystem::path> pictures;  // .png, of the same names; none without gnuplot
};

/// Writes a script beside its picture-to-be, and draws it where gnuplot is installed. Throws Error
/// when the folder cannot be written or gnuplot fails.
void draw_figure(const GnuplotScript& script, const std::filesystem::path& picture,
                 Figures& figures);

/// In double quotes, as gnuplot reads them: nothing in it is a command or an enhanced-text mark.
std::string gnuplot_quote(const std::string& text);

}  // namespace rimlight
