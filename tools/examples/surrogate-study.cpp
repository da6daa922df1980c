/// \file
/// Example 1 of Gnad et al. 2024 (section VII): what identification makes of a model whose parameters are known
/// exactly. Run by surrogate.sh, which makes trajectory, logs and identifications with the installed tools.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "deltadyn/identification/base_parameters.hpp"
#include "deltadyn/identification/consistent_fit.hpp"
#include "deltadyn/io/log_file.hpp"
#include "deltadyn/io/summary.hpp"
#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/workspace.hpp"

#include "examples/study.hpp"
#include "tool_support.hpp"

namespace {

using namespace deltadyn;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kDrives = 4;
constexpr double kSmallestError = 0.01;  // [%] that a figure shows
constexpr PlotColor kColors[] = {PlotColor::vermillion, PlotColor::green};

/// The terms of (1) of one model along a motion; rows are samples.
struct Terms {
  MatrixXd coriolis, acceleration, gravity;  ///< samples x drives [N m]
  std::vector<MatrixXd> M;
  bool positive_definite = true;
};

Terms terms_along(const Robot& robot, VectorXd p, const Log& motion) {
  for (int k = 0; k < robot.parameters(); ++k) {
    if (robot.parameter_ids()[static_cast<std::size_t>(k)].is_friction()) p(k) = 0;
  }
  Terms terms;
  const Index samples = motion.samples();
  terms.coriolis.resize(samples, kDrives);
  terms.acceleration.resize(samples, kDrives);
  terms.gravity.resize(samples, kDrives);
  const VectorXd zero = VectorXd::Zero(kDrives);
  VectorXd gravity(kDrives), moving(kDrives);
  MatrixXd M(kDrives, kDrives);
  for (Index k = 0; k < samples; ++k) {
    const VectorXd q = motion.q.row(k), qd = motion.qd.row(k), qdd = motion.qdd.row(k);
    if (robot.inverse_dynamics(q, zero, zero, p, gravity) != Status::ok ||
        robot.inverse_dynamics(q, qd, zero, p, moving) != Status::ok || robot.mass_matrix(q, p, M) != Status::ok) {
      throw Error("a pose of the motion is out of reach", motion.file, "");
    }
    terms.coriolis.row(k) = moving - gravity;
    terms.gravity.row(k) = gravity;
    terms.acceleration.row(k) = M * qdd;
    terms.positive_definite = terms.positive_definite && dense::cholesky(M).positive_definite;
    terms.M.push_back(M);
  }
  return terms;
}

struct Case {
  std::string label;  ///< "ID1"
  std::string prior;  ///< "RG1"
  VectorXd regularization, identified;
  Terms terms;
};

/// Errors of one case in percent, as the paper measures them.
struct Errors {
  double friction = 0, diagonal = 0, off_diagonal = 0, spindle = 0, coriolis = 0, acceleration = 0;
};

MatrixXd entry_along(const Terms& terms, int i, int j) {
  VectorXd values(static_cast<Index>(terms.M.size()));
  for (std::size_t k = 0; k < terms.M.size(); ++k) values(static_cast<Index>(k)) = terms.M[k](i, j);
  return values;
}

/// Error of an entry of M along the motion over its mean (paper, VII); entries of the spindle, whose mean is near zero,
/// over sqrt(Mii Mjj).
VectorXd relative_error(const Terms& nominal, const Terms& found, int i, int j) {
  const VectorXd truth = entry_along(nominal, i, j);
  double scale = std::abs(truth.mean());
  if (i == 3 && j != 3) scale = std::sqrt(entry_along(nominal, i, i).mean() * entry_along(nominal, j, j).mean());
  return (truth - VectorXd(entry_along(found, i, j))) / scale;
}

Errors errors_of(const Robot& robot, const VectorXd& truth, const Terms& nominal, const Case& result) {
  Errors e;
  for (int k = 0; k < robot.parameters(); ++k) {
    if (robot.parameter_ids()[static_cast<std::size_t>(k)].is_friction()) {
      e.friction = std::max(e.friction, 100 * std::abs(result.identified(k) / truth(k) - 1));
    }
  }
  for (int i = 0; i < kDrives; ++i) {
    for (int j = 0; j <= i; ++j) {
      const double worst = 100 * relative_error(nominal, result.terms, i, j).cwiseAbs().maxCoeff();
      double& figure = i == j ? e.diagonal : (i == 3 ? e.spindle : e.off_diagonal);
      figure = std::max(figure, worst);
    }
  }
  // "The difference is less than 1 % at any time": of the drive's largest torque of this kind. The spindle's Coriolis
  // torque is a few thousandths of the arms', so it is held against theirs.
  const auto share = [](const MatrixXd& exact, const MatrixXd& found) {
    const double largest = exact.cwiseAbs().maxCoeff();
    double worst = 0;
    for (int j = 0; j < kDrives; ++j) {
      const double own = exact.col(j).cwiseAbs().maxCoeff();
      worst = std::max(
          worst, 100 * (exact.col(j) - found.col(j)).cwiseAbs().maxCoeff() / (own < 0.05 * largest ? largest : own));
    }
    return worst;
  };
  e.coriolis = share(nominal.coriolis, result.terms.coriolis);
  e.acceleration = share(nominal.acceleration, result.terms.acceleration);
  return e;
}

// --- figures ---------------------------------------------------------------------------------------

/// Figure 3: every parameter of the reduced set, as a share of the nominal value.
void add_parameter_figure(study::Figures& figures, const Robot& robot, const VectorXd& truth,
                          const std::vector<Case>& cases) {
  std::vector<int> shown;
  PlotSpec spec;
  for (int k = 0; k < robot.parameters(); ++k) {
    if (truth(k) == 0) continue;
    shown.push_back(k);
    spec.x_tick_labels.push_back(robot.parameter_names()[static_cast<std::size_t>(k)]);
  }
  const auto count = static_cast<Index>(shown.size());
  const auto ratio = [&](const VectorXd& p) {
    VectorXd y(count);
    for (Index k = 0; k < count; ++k) {
      const int column = shown[static_cast<std::size_t>(k)];
      y(k) = std::clamp(p(column) / truth(column), 0.0, 2.0);
    }
    return y;
  };
  const VectorXd x = VectorXd::LinSpaced(count, 0, static_cast<double>(count - 1));
  spec.y_label = "value / nominal value";
  spec.height = 420;
  for (std::size_t c = 0; c < cases.size(); ++c) {
    const double shift = c == 0 ? -0.15 : 0.15;
    spec.series.push_back({cases[c].prior,
                           x.array() + shift,
                           ratio(cases[c].regularization),
                           SeriesStyle::steps,
                           {},
                           PlotColor::grey,
                           c == 1});
    spec.series.back().style = SeriesStyle::line;
    spec.series.push_back(
        {cases[c].label, x.array() + shift, ratio(cases[c].identified), SeriesStyle::points, {}, kColors[c], false});
  }
  spec.horizontal_markers.push_back({1.0, "nominal"});
  spec.y_range = PlotRange{0, 2.05};
  figures.add("figure3_parameters", {spec},
              "The paper's Figure 3: nominal values (line at 1), the two priors (grey: RG1 drawn through, RG2 dashed) "
              "and what is "
              "identified from them; values beyond 2 are drawn at 2. Parameters that no motion shows on their own stay "
              "near their "
              "prior; friction and everything that acts alone does not.");
}

void add_mass_figure(study::Figures& figures, const Log& motion, const Terms& nominal, const std::vector<Case>& cases,
                     const std::string& name, const std::string& caption) {
  std::vector<PlotSpec> panels;
  for (int i = 0; i < kDrives; ++i) {
    for (int j = 0; j <= i; ++j) {
      if (i == 3 && j < 3) continue;
      PlotSpec spec;
      spec.y_label = fmt::format("M{}{} [%]", j + 1, i + 1);
      spec.x_label = "time [s]";
      spec.height = 170;
      for (std::size_t c = 0; c < cases.size(); ++c) {
        spec.series.push_back({cases[c].label,
                               motion.t_s,
                               100 * relative_error(nominal, cases[c].terms, i, j),
                               SeriesStyle::line,
                               {},
                               kColors[c],
                               c == 1});
      }
      // Errors of rounding would stretch the axis to 1e-12 %.
      double largest = 0;
      for (const Series& series : spec.series) largest = std::max(largest, series.y.cwiseAbs().maxCoeff());
      if (largest < kSmallestError) spec.y_range = PlotRange{-kSmallestError, kSmallestError};
      panels.push_back(spec);
    }
  }
  figures.add(name, panels, caption);
}

void add_torque_figure(study::Figures& figures, const Log& motion, const MatrixXd& nominal,
                       const std::vector<const MatrixXd*>& found, const std::vector<Case>& cases,
                       const std::string& name, const std::string& what, const std::string& caption) {
  std::vector<PlotSpec> panels;
  for (int j = 0; j < kDrives; ++j) {
    PlotSpec spec;
    spec.y_label = fmt::format("{}{} [N m]", what, j + 1);
    spec.x_label = "time [s]";
    spec.height = 180;
    spec.series.push_back({"nominal", motion.t_s, nominal.col(j), SeriesStyle::line, {}, PlotColor::black, false});
    for (std::size_t c = 0; c < cases.size(); ++c) {
      spec.series.push_back({cases[c].label, motion.t_s, found[c]->col(j), SeriesStyle::line, {}, kColors[c], true});
    }
    panels.push_back(spec);
  }
  figures.add(name, panels, caption);
}

// --- 61, 36 and 37 -----------------------------------------------------------------------------------

/// Which columns the fit of section VI moves, told by the fit itself.
ConsistentFitSummary reduced_fit(const Robot& robot, const VectorXd& prior) {
  WorkspaceSampler sampler(robot, 1);
  constexpr int kStates = 60;
  ConsistentFitProblem problem;
  problem.parameters = robot.parameter_ids();
  problem.A.resize(kStates * kDrives, robot.parameters());
  VectorXd q(kDrives), qd(kDrives), qdd(kDrives);
  MatrixXd Y(kDrives, robot.parameters());
  for (int k = 0; k < kStates;) {
    sampler.next(q, qd, qdd);
    if (robot.regressor(q, qd, qdd, Y) != Status::ok) continue;
    problem.A.middleRows(kDrives * k++, kDrives) = Y;
  }
  problem.prior = prior;
  problem.b = problem.A * prior;
  ConsistentFitOptions options;
  options.regularization = 1;
  return fit_consistent_parameters(problem, options);
}

/// Variables of section VI for one body, with the paper's reason.
struct BodyRow {
  const char *body, *variables, *values, *dropped;
  int count;
};
constexpr BodyRow kSectionVi[] = {
    {"upper_arm", "d1 d3 t1 t3", "m, mcx, mcz, Iyy",
     "turns about y only: mcy, Ixx, Izz do nothing (b); products: frame along the axes (a)", 4},
    {"strut", "α d1 d2 d3 t1", "m, mcx, Ixx, Iyy, Izz", "mcy, mcz: hardly excited (c); products (a)", 5},
    {"platform", "α", "m", "only translates (e)", 1},
    {"tool", "α d1 d2 t1 t2", "m, mcx, mcy, Izz", "turns about z only (f)", 5},
    {"telescope_upper", "α d1 d2 d3 t3", "m, mcz, Ixx, Iyy, Izz", "symmetric about the bar (d); products (a)", 5},
    {"telescope_lower", "α d1 d2 d3 t3", "m, mcz, Ixx, Iyy, Izz", "symmetric about the bar (d); products (a)", 5}};

void explain_counts(HtmlReport& report, const Robot& robot, const RobotDescription& description, const VectorXd& prior,
                    Summary& summary) {
  const BaseParameters base = find_base_parameters(robot);
  const ConsistentFitSummary reduced = reduced_fit(robot, prior);
  ParameterOptions with_motor;
  with_motor.rotor_inertia = {4};
  const auto motor = make_robot(description, with_motor);
  VectorXd motor_prior(motor->parameters());
  motor_prior << prior, 2e-3;
  const ConsistentFitSummary reduced_motor = reduced_fit(*motor, motor_prior);
  const int base_motor = find_base_parameters(*motor).count();
  summary.add("base_parameters", base.count());
  summary.add("variables", reduced.variables);
  summary.add("variables_with_rotor_inertia", reduced_motor.variables);

  report.heading("61, 36 and 37 of section VI");
  report.paragraph(fmt::format(
      "61 is what full bodies would take: ten parameters for each of upper arm, strut, tool and the two parts of the "
      "telescope, the mass "
      "of the plate, which only translates, and ten friction coefficients: 5 × 10 + 1 + 10. 36 are the variables of "
      "the reduced set: 4 "
      "+ 5 + 1 + 5 + 5 + 5 = 25 for the bodies, 10 for friction, and the lumped inertia of the fourth motor, which "
      "the paper identifies "
      "separately (VIII.B). Here the fit counts {} variables with --rotor-inertia 4 and {} without: the motor's "
      "inertia and the tool's Izz act "
      "on the torque in the same way, so the tool can carry it, and the base parameters stay {} ({} with the motor's "
      "column). 37 is the rank of the "
      "regressor, found over random states.",
      reduced_motor.variables, reduced.variables, base.count(), base_motor));
  Table bodies({{"body", Align::left},
                {"variables π", Align::left},
                {"for the parameters", Align::left},
                {"count"},
                {"left out", Align::left}});
  int total = 0;
  for (const BodyRow& row : kSectionVi) {
    bodies.row({row.body, row.variables, row.values, std::to_string(row.count), row.dropped});
    total += row.count;
  }
  bodies.row({"friction", "β σ", "viscous and Coulomb of five joints", "10", ""});
  bodies.row({"fourth motor", "ln I", "lumped inertia", "1", "told apart from tool.Izz by its prior only"});
  bodies.row({"sum", "", "", std::to_string(total + 11), ""}, Tone::strong);
  report.table(bodies, "Variables of the reduced set, body by body, with the paragraph of section VI.");

  report.details("Every parameter, and the 37 base parameters", [&](HtmlReport& page) {
    Table each({{"parameter", Align::left}, {"in the reduced set", Align::left}, {"in base parameters", Align::left}});
    for (int k = 0; k < robot.parameters(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      const auto own = std::find(base.independent.begin(), base.independent.end(), k);
      const double weight = base.B.col(k).cwiseAbs().maxCoeff();
      std::string role = "not at all: no motion shows it";
      if (own != base.independent.end())
        role = fmt::format("leads number {}", own - base.independent.begin() + 1);
      else if (weight > 1e-9)
        role = "part of others";
      each.row({robot.parameter_names()[at], reduced.fitted[at] ? "free" : "0, or follows from others", role});
    }
    page.table(each);
    Table expressions({{"number"}, {"base parameter", Align::left}});
    for (std::size_t k = 0; k < base.expressions.size(); ++k)
      expressions.row({std::to_string(k + 1), base.expressions[k]});
    page.table(expressions);
  });
}

// --- the study -----------------------------------------------------------------------------------------

struct Inputs {
  std::string folder, robot, nominal;
};

ExitCode run_study(const Inputs& in, Summary& summary) {
  const std::filesystem::path folder = in.folder;
  const auto file = [&](const std::string& name) { return (folder / name).string(); };
  const RobotDescription description = read_robot_file(in.robot);
  const auto robot = make_robot(description);
  const VectorXd truth = study::read_values(*robot, in.nominal);
  LogReadOptions as_it_is;
  as_it_is.need_derivatives = true;
  as_it_is.check = false;
  const Log motion = read_log(file("log_exact.csv"), description, as_it_is);
  const Terms nominal = terms_along(*robot, truth, motion);
  const auto load = [&](const std::string& noise) {
    std::vector<Case> cases;
    for (const int k : {1, 2}) {
      Case c;
      c.label = fmt::format("ID{}", k);
      c.prior = fmt::format("RG{}", k);
      c.regularization = study::read_values(*robot, file(fmt::format("prior{}.csv", k)));
      c.identified = study::read_values(*robot, file(fmt::format("identified{}{}.csv", k, noise)));
      c.terms = terms_along(*robot, c.identified, motion);
      cases.push_back(std::move(c));
    }
    return cases;
  };
  const std::vector<Case> clean = load(""), noisy = load("_noise"), closed = load("_closed");

  HtmlReport report("Example 1: surrogate model", "Gnad et al. 2024, section VII, with " + description.name);
  std::vector<study::Figure> figures;
  bool definite = true;
  const auto compare = [&](const std::vector<Case>& cases, const std::string& suffix, const Errors& paper,
                           const Errors& target) {
    for (const Case& c : cases) {
      const Errors e = errors_of(*robot, truth, nominal, c);
      definite = definite && c.terms.positive_definite;
      const std::string tail = " " + c.label + suffix;
      const auto percent = [](double value) { return format_number(value, 3); };
      figures.push_back({"friction" + tail, percent(paper.friction), target.friction, e.friction});
      figures.push_back({"M diagonal" + tail, percent(paper.diagonal), target.diagonal, e.diagonal});
      figures.push_back({"M off-diagonal" + tail, percent(paper.off_diagonal), target.off_diagonal, e.off_diagonal});
      figures.push_back({"M spindle with arms" + tail, "", target.off_diagonal, e.spindle});
      figures.push_back({"Coriolis torque" + tail, percent(paper.coriolis), target.coriolis, e.coriolis});
      figures.push_back(
          {"acceleration torque" + tail, percent(paper.acceleration), target.acceleration, e.acceleration});
    }
  };
  const Errors paper{2.2, 1, 2, 2, 1, 1}, exact{0.2, 0.1, 0.2, 0.2, 0.1, 0.1};
  compare(clean, "", paper, exact);
  compare(noisy, " noise", paper, paper);
  compare(closed, " closed loop", paper, paper);

  study::Figures pictures(report, folder);
  report.paragraph(
      "A model with known parameters moves along an optimal trajectory; its torque is identified from two priors, one "
      "with every "
      "value too "
      "small (RG1), one with every value too large (RG2). ID1 and ID2 are the results. Errors are measured as in the "
      "paper: "
      "entries of M "
      "over their mean along the trajectory, torques over the largest of their kind. \"noise\" adds torque noise of 1 "
      "% of each "
      "drive's "
      "largest torque to the exact motion. \"closed loop\" is what a real robot would record: sampled control, 19-bit "
      "encoders "
      "and the same "
      "noise, read through the tools' filters.");
  report.heading("Ours beside the paper's");
  const bool met = study::conclude(figures, report, summary, "%");
  report.note(definite ? "Every identified mass matrix is positive definite along the trajectory."
                       : "An identified mass matrix is not positive definite somewhere on the trajectory.");
  summary.add("positive_definite", definite ? "yes" : "no");
  report.heading("Parameters");
  add_parameter_figure(pictures, *robot, truth, clean);
  report.heading("Mass matrix");
  add_mass_figure(
      pictures, motion, nominal, clean, "figure4_mass_matrix",
      "The paper's Figure 4, noise-free: relative errors of the six entries of the arms' block of M and of M44.");
  add_mass_figure(pictures, motion, nominal, noisy, "figure4_mass_matrix_noise", "The same with torque noise of 1 %.");
  report.heading("Coriolis and acceleration torque");
  add_torque_figure(
      pictures, motion, nominal.coriolis, {&noisy[0].terms.coriolis, &noisy[1].terms.coriolis}, noisy,
      "figure5_coriolis", "τ",
      "The paper's Figure 5, with torque noise of 1 %: C(q, q̇) q̇ of the nominal and the identified models.");
  add_torque_figure(pictures, motion, nominal.acceleration,
                    {&noisy[0].terms.acceleration, &noisy[1].terms.acceleration}, noisy, "figure6_acceleration", "τ",
                    "The paper's Figure 6, with torque noise of 1 %: M(q) q̈.");
  explain_counts(report, *robot, description, clean[0].regularization, summary);
  report.footer("tools/examples/surrogate.sh");
  write_file(file("report.html"), report.str());
  summary.add("verdict", met && definite ? "met" : "missed");
  fmt::print("report: {}\n", file("report.html"));
  return met && definite ? ExitCode::done : ExitCode::not_trusted;
}

}  // namespace

int main(int argc, char** argv) {
  Inputs in;
  return tools::run_tool(
      argc, argv,
      {"surrogate-study", "Compares the identifications that surrogate.sh has made with the nominal model.",
       "surrogate-study results robot.urdf nominal.csv"},
      [&](CLI::App& app, tools::ToolRun& run) {
        app.add_option("folder", in.folder, "folder with the logs and identifications")->required();
        app.add_option("robot", in.robot, "robot file (URDF)")->required();
        app.add_option("nominal", in.nominal, "nominal parameters (CSV)")->required();
        run.on(app, [&] { return run_study(in, run.summary); });
      });
}
