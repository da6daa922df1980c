#include "deltadyn/report/plot.hpp"

#include <cstring>
#include <fmt/format.h>

#include "deltadyn/io/output_file.hpp"
#include "deltadyn/runtime/error.hpp"

#include "child_process.hpp"
#include "gnuplot_script.hpp"
#include "svg_tidy.hpp"

namespace deltadyn {
namespace {

constexpr const char* kMend = "install gnuplot-nox (apt-get install gnuplot-nox)";

std::string first_title(const std::vector<PlotSpec>& panels) {
  for (const PlotSpec& spec : panels)
    if (!spec.title.empty()) return spec.title;
  return "";
}

/// \param terminal   gnuplot's terminal with its options, without fonts and size
/// \param font_size  in the terminal's own unit
/// \param scale      picture points a pixel
std::string draw(const std::vector<PlotSpec>& panels, const std::string& terminal, double font_size, int scale) {
  const GnuplotScript script = gnuplot_script(panels);
  const std::string input = fmt::format(
      "set encoding utf8\nset terminal {} enhanced font 'sans,{}' background rgb 'white' size {},{}\n"
      "title_font = 'sans:Bold,{}'\nsmall_font = 'sans,{}'\n{}",
      terminal, font_size, scale * script.width, scale * script.height, 1.04 * font_size, 0.9 * font_size, script.body);
  // -d: a user's own ~/.gnuplot must not change the report.
  const ProcessResult result = run_process({"gnuplot", "-d"}, input);
  const std::string where = "plot \"" + first_title(panels) + "\"";
  if (result.start_error != 0) {
    throw Error(fmt::format("gnuplot cannot be started: {}", std::strerror(result.start_error)), where, kMend);
  }
  if (result.exit_code != 0 || result.output.empty()) {
    throw Error(fmt::format("gnuplot failed with exit code {}: {}", result.exit_code, result.errors), where, kMend);
  }
  return result.output;
}

}  // namespace

std::string render_svg(const std::vector<PlotSpec>& panels, std::string_view id_prefix) {
  return tidy_svg(draw(panels, "svg", 12.5, 1), id_prefix, first_title(panels));
}

void render_png(const std::vector<PlotSpec>& panels, const std::filesystem::path& path) {
  write_file(path.string(), draw(panels, "pngcairo fontscale 2 linewidth 2 pointscale 2", 9.5, 2));
}

bool gnuplot_available() {
  const ProcessResult result = run_process({"gnuplot", "--version"}, "");
  return result.start_error == 0 && result.exit_code == 0;
}

}  // namespace deltadyn
