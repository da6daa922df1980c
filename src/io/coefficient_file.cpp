#include "deltadyn/io/coefficient_file.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "deltadyn/io/output_file.hpp"
#include "deltadyn/trajectory/task_columns.hpp"

namespace deltadyn {
void write_coefficients(const std::string& path, const std::vector<FourierSeries>& segments,
                        const RobotDescription& robot) {
  std::string text = "segment,harmonic,frequency_hz";
  for (const TaskColumns& column : task_columns(robot))
    text += fmt::format(",{0}_sin{1},{0}_cos{1}", column.name, column.rotation ? "_rad" : "_m");
  text += "\n";
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const FourierSeries& series = segments[k];
    for (int h = 0; h <= series.harmonics(); ++h) {
      text += fmt::format("{},{},{}", k + 1, h, series.base_frequency_hz * std::max(1, h));
      for (int i = 0; i < series.coordinates(); ++i) {
        const double sine = h == 0 ? 0.0 : series.coefficients(2 * h - 1, i);
        text += fmt::format(",{},{}", sine, series.coefficients(2 * h, i));
      }
      text += "\n";
    }
  }
  write_file(path, text);
}

}  // namespace deltadyn
