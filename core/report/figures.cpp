#include "core/report/figures.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/report/run_summary.h"

namespace rimlight {
namespace {

using Rows = std::vector<std::vector<double>>;

/// A light's name as a part of a file's name.
std::string file_part(const std::string& name) {
  std::string part;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    part += plain ? c : '_';
  }
  return part.empty() ? "light" : part;
}

/// One light's rows, run by run.
std::vector<std::vector<const FrameRow*>> runs_of(const ErrorVsTimeReport& report,
                                                  const std::string& light) {
  std::vector<std::vector<const FrameRow*>> runs;
  for (const FrameRow& row : report.rows) {
    if (row.light != light) continue;
    if (runs.empty() || runs.back().front()->run != row.run) runs.emplace_back();
    runs.back().push_back(&row);
  }
  return runs;
}

/// What a logarithmic axis has a place for: what is exact, or nothing, has none.
double positive_or_nan(double value) { return value > 0 ? value : NAN; }

/// Whether any point can be drawn: gnuplot fails at a plot without.
bool has_point(const Rows& points) {
  return std::ranges::any_of(points, [](const auto& row) { return std::isfinite(row[1]); });
}

/// "plot A, B, C" of data blocks d0, d1, …
std::string plot_line(const std::vector<std::string>& parts) {
  std::string line = "plot ";
  for (const std::string& part : parts) line += (part == parts.front() ? "" : ", \\\n  ") + part;
  return line;
}

class LightFigures {
 public:
  LightFigures(const ErrorVsTimeReport& report, const LightReport& light,
               const std::filesystem::path& folder, Figures& figures)
      : report_(report),
        light_(light),
        folder_(folder),
        figures_(figures),
        runs_(runs_of(report, light.light)) {}

  void draw() {
    draw_against_frame("lighting-error", "error of the light, area-weighted L1, relative",
                       &FrameRow::lighting_error);
    draw_against_frame("image-error", "error of the image, L2, relative", &FrameRow::relative_l2);
    draw_against_time();
    draw_against_terms();
    draw_resets();
    draw_norms();
    draw_coverage();
    draw_histogram();
  }

 private:
  std::string picture(const std::string& name) const {
    return name + "-" + file_part(light_.light) + ".png";
  }

  std::string title(const std::string& what) const {
    return "set title " + gnuplot_quote(what + ": " + report_.scene + ", " + light_.light + ", " +
                                        report_.sequence);
  }

  void finish(const std::string& name, const GnuplotScript& script) {
    draw_figure(script, folder_ / picture(name), figures_);
  }

  void draw_against_frame(const std::string& name, const std::string& label,
                          double FrameRow::*value) {
    GnuplotScript script(picture(name));
    script.add(title("Error against frame"));
    script.add("set xlabel \"frame\"\nset logscale y\nset key outside right");
    script.add("set ylabel " + gnuplot_quote(label));
    std::vector<std::string> parts;
    for (const auto& run : runs_) {
      Rows rows;
      for (const FrameRow* const row : run) {
        rows.push_back({static_cast<double>(row->frame), positive_or_nan(row->*value)});
      }
      if (!has_point(rows)) continue;
      const std::string data = "d" + std::to_string(parts.size());
      script.add_data(data, rows);
      parts.push_back("$" + data + " using 1:2 with lines lw 1.5 title " +
                      gnuplot_quote(run.front()->run));
    }
    if (parts.empty()) return;
    script.add(plot_line(parts));
    finish(name, script);
  }

  void draw_against_time() {
    GnuplotScript script(picture("image-error-vs-ms"));
    script.add(title("Frames in motion"));
    script.add("set xlabel \"milliseconds a frame, median\"\nset logscale xy\nunset key");
    script.add(
        "set ylabel \"error of the image, L2, relative, mean\"\nset offsets graph 0.05, graph "
        "0.25, graph 0.05, graph 0.05");
    std::vector<std::string> parts;
    for (const RunSummary& run : summarize_runs(report_.rows)) {
      if (run.light != light_.light || !(run.moving.relative_l2 > 0)) continue;
      const std::string data = "d" + std::to_string(parts.size());
      script.add_data(data, {{run.moving.median_ms, run.moving.relative_l2}});
      parts.push_back("$" + data + " using 1:2:(" + gnuplot_quote(" " + run.run) +
                      ") with labels left point pt 7");
    }
    if (parts.empty()) return;
    script.add(plot_line(parts));
    finish("image-error-vs-ms", script);
  }

  /// Figure 7.1: one line a policy in motion and one just after it.
  void draw_against_terms() {
    std::map<std::string, Rows> moving, after;
    for (const RunSummary& run : summarize_runs(report_.rows)) {
      if (run.light != light_.light || !is_count(run.budget)) continue;
      const double terms = std::stod(run.budget);
      if (run.moving.frames > 0) moving[run.policy].push_back({terms, run.moving.psnr_db});
      if (run.just_after.frames > 0) after[run.policy].push_back({terms, run.just_after.psnr_db});
    }
    if (moving.empty()) return;
    GnuplotScript script(picture("quality-vs-terms"));
    script.add(title("Quality against terms"));
    script.add("set xlabel \"terms a frame\"\nset logscale x\nset key outside right");
    script.add("set ylabel \"PSNR as displayed, dB\"");
    std::vector<std::string> parts;
    const auto add = [&](const std::map<std::string, Rows>& lines, const std::string& when,
                         const std::string& style) {
      for (auto [policy, rows] : lines) {
        std::sort(rows.begin(), rows.end());
        const std::string data = "d" + std::to_string(parts.size());
        script.add_data(data, rows);
        parts.push_back("$" + data + " using 1:2 with linespoints " + style + " title " +
                        gnuplot_quote(policy + when));
      }
    };
    add(moving, " in motion", "pt 7");
    add(after, ", " + std::to_string(kJustAfter) + " frames after", "pt 6 dt 2");
    script.add(plot_line(parts));
    finish("quality-vs-terms", script);
  }

  static bool is_count(const std::string& budget) {
    return std::ranges::all_of(budget, [](char c) { return c >= '0' && c <= '9'; });
  }

  /// Figure 6.4: a mark where a band was reset, a row of panels by run.
  void draw_resets() {
    std::vector<std::vector<const FrameRow*>> incremental;
    for (const auto& run : runs_) {
      if (run.front()->policy.starts_with("pbi") || run.front()->policy == "benefit") {
        incremental.push_back(run);
      }
    }
    if (incremental.empty()) return;
    const auto count = static_cast<int>(incremental.size());
    GnuplotScript script(picture("resets"), 1000, 80 + 170 * count);
    script.add("set multiplot layout " + std::to_string(count) + ",1");
    script.add("unset key\nset xlabel \"frame\"\nset ylabel \"band, coarse to fine\"\nset ytics 1");
    for (int i = 0; i < count; ++i) {
      const auto& run = incremental[static_cast<std::size_t>(i)];
      const int bands = static_cast<int>(run.front()->columns_of_band.size());
      Rows rows;
      for (const FrameRow* const row : run) {
        for (int band = 0; band < bands; ++band) {
          if ((row->reset_bands >> band & 1) == 0) continue;
          rows.push_back({static_cast<double>(row->frame), band - 0.35, 0, 0.7});
        }
      }
      if (rows.empty()) rows.push_back({NAN, NAN, 0, 0});
      script.add_data("d" + std::to_string(i), rows);
      script.add("set title " + gnuplot_quote("Resets of " + run.front()->run));
      script.add("plot [0:" + std::to_string(run.size()) + "] [-0.6:" + std::to_string(bands) +
                 "-0.4] $d" + std::to_string(i) + " using 1:2:3:4 with vectors nohead lw 1.5");
    }
    script.add("unset multiplot");
    finish("resets", script);
  }

  /// Figure 5.4.
  void draw_norms() {
    if (light_.spatio_temporal_norms.empty()) return;
    Rows rows;
    const double frames = std::exp2(light_.spatio_temporal_norms.size() - 1);
    for (std::size_t t = 0; t < light_.spatio_temporal_norms.size(); ++t) {
      for (std::size_t band = 0; band < light_.spatio_temporal_norms[t].size(); ++band) {
        const double norm = light_.spatio_temporal_norms[t][band];
        rows.push_back(
            {static_cast<double>(band), static_cast<double>(t), std::log10(std::max(norm, 1e-12))});
      }
    }
    GnuplotScript script(picture("spatio-temporal"), 700, 600);
    script.add(title("Norm of the light by spatial and temporal band"));
    script.add("set xlabel \"spatial band, coarse to fine\"\nset xtics 1\nset ytics 1\nunset key");
    script.add("set ylabel " + gnuplot_quote("temporal band, coarse to fine, of " +
                                             std::to_string(static_cast<int>(frames)) + " frames"));
    script.add("set palette defined (0 \"white\", 1 \"black\")\nset cblabel \"log10 of the norm\"");
    script.add_data("d", rows);
    script.add("plot $d using 1:2:3 with image");
    finish("spatio-temporal", script);
  }

  /// Figure 5.3, top: one panel a run and interval, the six faces side by side.
  void draw_coverage() {
    if (light_.coverage.empty()) return;
    const auto count = static_cast<int>(light_.coverage.size());
    const auto intervals = static_cast<int>(
        std::ranges::count(light_.coverage, light_.coverage.front().run, &CoverageSample::run));
    const int down = (count + intervals - 1) / intervals;
    GnuplotScript script(picture("coverage"), 420 * intervals, 30 + 120 * down);
    script.add("set multiplot layout " + std::to_string(down) + "," + std::to_string(intervals));
    script.add("unset key\nunset tics\nunset grid\nunset colorbox\nset size ratio -1");
    script.add("set palette defined (0 \"white\", 1 \"black\")");
    const std::size_t bands = light_.coverage.front().coverage.columns_of_band.size();
    script.add("set cbrange [0:" + std::to_string(bands) + "]");
    for (int i = 0; i < count; ++i) {
      const CoverageSample& sample = light_.coverage[static_cast<std::size_t>(i)];
      const std::string data = "d" + std::to_string(i);
      script.add_data(data, strip(sample.coverage.bands_over_texel));
      script.add("set title " +
                 gnuplot_quote(sample.run + ", frames " + std::to_string(sample.first_frame) +
                               " to " + std::to_string(sample.first_frame + sample.frames - 1)));
      script.add("plot $" + data + " matrix with image");
    }
    script.add("unset multiplot");
    finish("coverage", script);
  }

  /// Faces side by side, the top row last, as gnuplot draws a matrix.
  Rows strip(const std::vector<double>& texels) const {
    const auto n = static_cast<std::size_t>(report_.cube_size);
    Rows rows(n);
    for (std::size_t y = 0; y < n; ++y) {
      for (std::size_t face = 0; face < 6; ++face) {
        const double* const row = texels.data() + (face * n + n - 1 - y) * n;
        rows[y].insert(rows[y].end(), row, row + n);
      }
    }
    return rows;
  }

  /// Figure 5.3, bottom.
  void draw_histogram() {
    if (light_.coverage.empty()) return;
    GnuplotScript script(picture("coverage-histogram"));
    script.add(title("Columns updated within some frames, by band"));
    script.add("set xlabel \"band, coarse to fine\"\nset ylabel \"columns\"\nset logscale y");
    script.add("set key outside right\nset xtics 1");
    std::vector<std::string> parts;
    for (const CoverageSample& sample : light_.coverage) {
      Rows rows;
      for (const int columns : sample.coverage.columns_of_band) {
        rows.push_back({static_cast<double>(rows.size()), positive_or_nan(columns)});
      }
      if (!has_point(rows)) continue;
      const std::string data = "d" + std::to_string(parts.size());
      script.add_data(data, rows);
      parts.push_back("$" + data + " using 1:2 with linespoints title " +
                      gnuplot_quote(sample.run + ", frame " + std::to_string(sample.first_frame)));
    }
    if (parts.empty()) return;
    script.add(plot_line(parts));
    finish("coverage-histogram", script);
  }

  const ErrorVsTimeReport& report_;
  const LightReport& light_;
  const std::filesystem::path& folder_;
  Figures& figures_;
  std::vector<std::vector<const FrameRow*>> runs_;
};

}  // namespace

Figures draw_figures(const ErrorVsTimeReport& report, const std::filesystem::path& folder) {
  Figures figures;
  for (const LightReport& light : report.lights) {
    LightFigures(report, light, folder, figures).draw();
  }
  return figures;
}

}  // namespace rimlight
