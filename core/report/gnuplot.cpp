#include "core/report/gnuplot.h"

#include <spawn.h>
#include <sys/wait.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>

#include "core/base/error.h"
#include "core/base/files.h"

extern char** environ;  // NOLINT: POSIX names it so

namespace rimlight {

bool run_gnuplot(const std::filesystem::path& script) {
  // The script names its picture without a folder.
  const std::string folder = script.parent_path().string(), file = script.filename().string();
  std::string program = "gnuplot", name = file;
  std::array<char*, 3> arguments = {program.data(), name.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (!folder.empty()) posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  pid_t process = -1;
  const int fault = posix_spawnp(&process, "gnuplot", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (fault != 0) return false;
  int status = -1;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127) return false;
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return true;
  throw Error(script.string(), "a failure of gnuplot", "a picture");
}

GnuplotScript::GnuplotScript(const std::string& picture, int width, int height) {
  add("set terminal pngcairo noenhanced size " + std::to_string(width) + "," +
      std::to_string(height) + " font \"DejaVu Sans,10\" background \"white\"");
  add("set output " + gnuplot_quote(picture));
  add("set grid lc rgb \"#dddddd\"\nset format y \"%g\"");
  const char* const colours[] = {"#1b9e77", "#66a61e", "#a6761d", "#e6ab02", "#7570b3", "#1f78b4",
                                 "#e31a1c", "#08306b", "#fb6a4a", "#000000", "#e7298a", "#969696"};
  int type = 0;
  for (const char* const colour : colours) {
    add("set linetype " + std::to_string(++type) + " lc rgb " + gnuplot_quote(colour));
  }
  add("set linetype cycle " + std::to_string(type));
}

void GnuplotScript::add(const std::string& line) { text_ += line + "\n"; }

void GnuplotScript::add_data(const std::string& name,
                             const std::vector<std::vector<double>>& rows) {
  text_ += "$" + name + " << EOD\n";
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      char number[32];
      std::snprintf(number, sizeof number, "%s%.6g", i == 0 ? "" : " ", row[i]);
      text_ += std::isfinite(row[i]) ? number : " NaN";
    }
    text_ += "\n";
  }
  text_ += "EOD\n";
}

std::string gnuplot_quote(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\' || c == '`') quoted += '\\';
    quoted += c < ' ' && c >= 0 ? ' ' : c;
  }
  return quoted + "\"";
}

void draw_figure(const GnuplotScript& script, const std::filesystem::path& picture,
                 Figures& figures) {
  std::filesystem::path path = picture;
  path.replace_extension(".gp");
  write_file_atomically(path, script.text());
  figures.scripts.push_back(path);
  if (run_gnuplot(path)) figures.pictures.push_back(picture);
}

}  // namespace rimlight
