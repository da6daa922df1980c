#include "excitation_figures.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>

#include "deltadyn/report/plot.hpp"
#include "deltadyn/trajectory/task_columns.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using Eigen::MatrixX3d;
using Eigen::VectorXd;

constexpr int kOutlinePoints = 72;
constexpr double kSeenFrom = 35.0 / 180 * std::numbers::pi;  // azimuth of the view
constexpr double kSeenFromAbove = 22.0 / 180 * std::numbers::pi;
constexpr int kPathWidth = 560, kPathHeight = 520;

/// Lines on the surface of the region, gaps between them.
MatrixX3d outline(const Region& region) {
  std::vector<Eigen::Vector3d> points;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto gap = [&] { points.emplace_back(nan, nan, nan); };
  const auto circle = [&](const Eigen::Vector3d& centre, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                          double turns) {
    for (int k = 0; k <= kOutlinePoints; ++k) {
      const double a = turns * 2 * std::numbers::pi * k / kOutlinePoints;
      points.emplace_back(centre + std::cos(a) * u + std::sin(a) * v);
    }
    gap();
  };
  const auto line = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    points.push_back(a);
    points.push_back(b);
    gap();
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d& c = region.centre;
  switch (region.shape) {
    case RegionShape::ball:
    case RegionShape::half_ball: {
      const double turns = region.shape == RegionShape::ball ? 1.0 : 0.5;
      circle(c, region.radius * x, region.radius * y, 1);
      circle(c, region.radius * x, -region.radius * z, turns);
      circle(c, region.radius * y, -region.radius * z, turns);
      break;
    }
    case RegionShape::cylinder:
    case RegionShape::cone: {
      const double low = region.radius, high = region.shape == RegionShape::cone ? region.top_radius : region.radius;
      const Eigen::Vector3d up = region.height / 2 * z;
      circle(c - up, low * x, low * y, 1);
      circle(c + up, high * x, high * y, 1);
      for (const Eigen::Vector3d& side : {x, y, Eigen::Vector3d(-x), Eigen::Vector3d(-y)})
        line(c - up + low * side, c + up + high * side);
      break;
    }
    case RegionShape::box: {
      for (int k = 0; k < 8; ++k) {
        for (int axis = 0; axis < 3; ++axis) {
          if ((k >> axis) % 2 == 1) continue;
          Eigen::Vector3d a = c;
          for (int i = 0; i < 3; ++i) a(i) += ((k >> i) % 2 == 1 ? 0.5 : -0.5) * region.size(i);
          line(a, a + region.size(axis) * Eigen::Vector3d::Unit(axis));
        }
      }
      break;
    }
  }
  MatrixX3d result(static_cast<Index>(points.size()), 3);
  for (std::size_t k = 0; k < points.size(); ++k) result.row(static_cast<Index>(k)) = points[k].transpose();
  return result;
}

struct View {
  const char* title;
  const char* x_label;
  const char* y_label;
  Eigen::Vector3d right, up;
};

PlotRange range_of(const VectorXd& a, const VectorXd& b, double margin) {
  PlotRange range{HUGE_VAL, -HUGE_VAL};
  for (const VectorXd* v : {&a, &b}) {
    const auto known = v->array().isFinite();
    range.low = std::min(range.low, known.select(v->array(), HUGE_VAL).minCoeff());
    range.high = std::max(range.high, known.select(v->array(), -HUGE_VAL).maxCoeff());
  }
  const double extra = margin * std::max(1e-9, range.high - range.low);
  return {range.low - extra, range.high + extra};
}

const PlanPart& part_at(const MotionPlan& plan, double t_s) {
  const PlanPart* part = &plan.parts.front();
  for (const PlanPart& other : plan.parts)
    if (t_s >= other.start_s - 1e-9) part = &other;
  return *part;
}

/// Rows of the samples while a segment runs, or the parts between.
MatrixX3d rows_of(const ExcitationReportInput& input, int segment, bool periodic) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  MatrixX3d path = input.samples.z.leftCols<3>();
  for (Index i = 0; i < path.rows(); ++i) {
    const double t = input.samples.t_s(i);
    const PlanPart& part = part_at(input.plan, t);
    const bool one_period =
        t - part.start_s <= input.segments[static_cast<std::size_t>(part.segment)].series.period_s() + 1e-3;
    const bool shown = periodic ? part.kind == PartKind::periodic && part.segment == segment && one_period
                                : part.kind != PartKind::periodic;
    if (!shown) path.row(i).setConstant(nan);
  }
  return path;
}

}  // namespace

void add_path_figures(HtmlReport& report, const ExcitationReportInput& input) {
  if (input.robot.description().parts.empty() || !input.segments.front().limits.region) return;
  const MatrixX3d border = outline(*input.segments.front().limits.region);
  const double ca = std::cos(kSeenFrom), sa = std::sin(kSeenFrom), ce = std::cos(kSeenFromAbove),
               se = std::sin(kSeenFromAbove);
  const View views[] = {
      {"Path of the plate in space, seen at an angle", "to the right [m]", "upwards in the picture [m]",
       Eigen::Vector3d(-sa, ca, 0), Eigen::Vector3d(-se * ca, -se * sa, ce)},
      {"From above", "x [m]", "y [m]", Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()},
      {"From the side, along y", "x [m]", "z [m]", Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ()},
      {"From the side, along x", "y [m]", "z [m]", Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()},
  };
  constexpr PlotColor kColors[] = {PlotColor::blue, PlotColor::vermillion, PlotColor::green, PlotColor::purple};
  for (const View& view : views) {
    PlotSpec spec{.title = view.title,
                  .x_label = view.x_label,
                  .y_label = view.y_label,
                  .width = kPathWidth,
                  .height = kPathHeight};
    const auto add = [&](const std::string& label, const MatrixX3d& points, PlotColor color, bool dashed) {
      spec.series.push_back({label, points * view.right, points * view.up, SeriesStyle::line, {}, color, dashed});
    };
    add("workspace", border, PlotColor::grey, false);
    for (std::size_t k = 0; k < input.segments.size(); ++k) {
      const std::string label = input.segments.size() == 1 ? "one period" : fmt::format("segment {}", k + 1);
      add(label, rows_of(input, static_cast<int>(k), true), kColors[k % std::size(kColors)], false);
    }
    if (input.plan.parts.size() > 1) add("run-in, run-out", rows_of(input, 0, false), PlotColor::orange, true);
    const VectorXd path_x = input.samples.z.leftCols<3>() * view.right,
                   path_y = input.samples.z.leftCols<3>() * view.up;
    PlotRange x = range_of(spec.series.front().x, path_x, 0.06), y = range_of(spec.series.front().y, path_y, 0.06);
    // The same scale on both axes, so that a circle is round.
    const double width = x.high - x.low, height = y.high - y.low,
                 across = std::max(width, height * kPathWidth / kPathHeight);
    const double tall = across * kPathHeight / kPathWidth;
    x = {(x.low + x.high - across) / 2, (x.low + x.high + across) / 2};
    y = {(y.low + y.high - tall) / 2, (y.low + y.high + tall) / 2};
    spec.x_range = x;
    spec.y_range = y;
    report.plot(spec);
  }
}

void add_limit_figures(HtmlReport& report, const ExcitationReportInput& input) {
  const RobotDescription& robot = input.robot.description();
  const int n = robot.drives();
  const Index count = input.samples.samples();
  struct Panel {
    const char* title;
    std::vector<LimitedQuantity> quantities;
  };
  const Panel panels[] = {
      {"Task space", {LimitedQuantity::region, LimitedQuantity::z, LimitedQuantity::zd, LimitedQuantity::zdd}},
      {"Drives", {LimitedQuantity::q, LimitedQuantity::qd, LimitedQuantity::qdd, LimitedQuantity::tau}},
  };
  std::vector<PlotSpec> specs;
  for (const Panel& panel : panels) {
    PlotSpec spec{.title = panel.title,
                  .x_label = "time [s]",
                  .y_label = "used share [%]",
                  .horizontal_markers = {{100, "limit"}},
                  .y_range = PlotRange{0, 110}};
    for (const LimitedQuantity quantity : panel.quantities) {
      Series series{.label = word_of(quantity), .x = input.samples.t_s, .y = VectorXd::Constant(count, -1)};
      for (Index i = 0; i < count; ++i) {
        const PlanPart& part = part_at(input.plan, input.samples.t_s(i));
        const MotionLimits& limits = input.segments[static_cast<std::size_t>(part.segment)].limits;
        LimitedState state;
        state.x.resize(3 * n);
        state.drives.resize(3 * n);
        state.tau = VectorXd::Zero(n);
        state.x << input.samples.z.row(i).transpose(), input.samples.zd.row(i).transpose(),
            input.samples.zdd.row(i).transpose();
        state.drives << input.samples.q.row(i).transpose(), input.samples.qd.row(i).transpose(),
            input.samples.qdd.row(i).transpose();
        if (quantity == LimitedQuantity::tau && limits.parameters.size() > 0 &&
            input.robot.inverse_dynamics(state.drives.head(n), state.drives.segment(n, n), state.drives.tail(n),
                                         limits.parameters, state.tau) != Status::ok)
          continue;
        for (const Limit& limit : limits.list(robot)) {
          if (limit.quantity != quantity) continue;
          const double load = limit_load(limit, usage_of(limit, limited_value(limit, limits, state)));
          series.y(i) = std::max(series.y(i), 100 * load);
        }
      }
      if (series.y.maxCoeff() >= 0) spec.series.push_back(series);
    }
    if (!spec.series.empty()) specs.push_back(spec);
  }
  report.plot(specs, "The limit of each kind that is used most, over time.");
}

}  // namespace deltadyn
