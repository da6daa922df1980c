#include "deltadyn/io/coefficient_file.hpp"

#include <cmath>
#include <fmt/format.h>

#include "deltadyn/io/csv.hpp"
#include "deltadyn/io/output_file.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/trajectory/task_columns.hpp"

namespace deltadyn {
namespace {

struct Names {
  std::string sine, cosine;
};

std::vector<Names> coefficient_columns(const RobotDescription& robot) {
  std::vector<Names> names;
  for (const TaskColumns& column : task_columns(robot)) {
    const char* unit = column.rotation ? "_rad" : "_m";
    names.push_back({column.name + "_sin" + unit, column.name + "_cos" + unit});
  }
  return names;
}

int whole(const CsvTable& table, std::size_t row, std::size_t column) {
  const double value = table.number(row, column);
  if (!(value >= 0 && value <= 1e6) || value != std::floor(value))
    throw Error(fmt::format("{} is not a count", value), place(table.path(), table.line(row), table.columns()[column]),
                "give a whole number");
  return static_cast<int>(value);
}

}  // namespace

void write_coefficients(const std::string& path, const std::vector<FourierSeries>& segments, const RobotDescription& robot) {
  OutputFile file(path);
  std::string text = "segment,harmonic,frequency_hz";
  for (const Names& name : coefficient_columns(robot)) text += "," + name.sine + "," + name.cosine;
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
  file.write(text);
  file.commit();
}

std::vector<FourierSeries> read_coefficients(const std::string& path, const RobotDescription& robot) {
  const CsvTable table = read_csv(path);
  const std::size_t segment = table.require("segment"), harmonic = table.require("harmonic");
  const std::size_t frequency = table.require("frequency_hz");
  const auto names = coefficient_columns(robot);
  std::vector<FourierSeries> segments;
  int expected = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const int h = whole(table, row, harmonic);
    const std::string where = place(path, table.line(row));
    if (h == 0) {
      segments.push_back({table.number(row, frequency), Eigen::MatrixXd(0, robot.drives())});
      expected = 0;
    }
    if (segments.empty() || h != expected || whole(table, row, segment) != static_cast<int>(segments.size()))
      throw Error("segments and harmonics are out of order", where,
                  "number segments from 1 and harmonics from 0, in rows of that order");
    ++expected;
    Eigen::MatrixXd& c = segments.back().coefficients;
    c.conservativeResize(1 + 2 * h, Eigen::NoChange);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      if (h > 0) c(2 * h - 1, at) = table.number(row, table.require(names[i].sine));
      c(2 * h, at) = table.number(row, table.require(names[i].cosine));
    }
  }
  for (const FourierSeries& series : segments) series.validate(path);
  return segments;
}

}  // namespace deltadyn
