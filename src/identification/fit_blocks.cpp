#include "fit_blocks.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn::fit {
namespace {

using namespace inertial;
using Vector10 = InertialVector<double>;

constexpr double kRounding = 1e-9;  // relative slack for priors written with a few digits on the boundary
constexpr double kInside = 1e-4;    // how far a prior on the boundary is moved inside, relative
constexpr double kThin = 1e-6;      // least second moment of a body along an axis, relative: a step has digits left
constexpr double kLength = 0.1;     // size [m] of a body of which the prior says a mass and nothing else
// A prior below this part of its natural scale says "about 0", not "to this precision"
constexpr double kTiny = 1e-3;

[[noreturn]] void refuse_prior(const std::string& body, const std::string& rule, const std::string& mend) {
  throw Error(fmt::format("the prior of body '{}' is not physically consistent: {}", body, rule), "prior, " + body,
              mend);
}

/// What section VI keeps of a body.
const Fitted& reduction_of(Body body) {
  using namespace log_cholesky;
  static const std::vector<Fitted> table = {
      // in the order of Body
      {BlockKind::planar, {kM, kMcx, kMcz, kIyy}, {kD1, kD3, kT1, kT3}, {0, 2}, kIyy},
      {BlockKind::spatial, {kM, kMcx, kIxx, kIyy, kIzz}, {kAlpha, kD1, kD2, kD3, kT1}, {0, 0}, 0},
      {BlockKind::point, {kM}, {kAlpha}, {0, 0}, 0},
      {BlockKind::planar, {kM, kMcx, kMcy, kIzz}, {kAlpha, kD1, kD2, kT1, kT2}, {0, 1}, kIzz},
      {BlockKind::spatial, {kM, kMcz, kIxx, kIyy, kIzz}, {kAlpha, kD1, kD2, kD3, kT3}, {0, 0}, 0},
      {BlockKind::spatial, {kM, kMcz, kIxx, kIyy, kIzz}, {kAlpha, kD1, kD2, kD3, kT3}, {0, 0}, 0},
      {BlockKind::point, {kM}, {kAlpha}, {0, 0}, 0},
      {BlockKind::planar, {kM, kMcx, kMcy, kIzz}, {kAlpha, kD1, kD2, kT1, kT2}, {0, 1}, kIzz},
  };
  return table.at(static_cast<std::size_t>(body));
}

/// Rules that hold for the inertia about any point: mass and triangle inequality.
void check_mass_and_triangle(const std::string& body, const Vector10& p) {
  if (p(kM) < 0) refuse_prior(body, fmt::format("its mass {:g} kg is negative", p(kM)), "give a positive mass");
  const Eigen::Matrix3d S = to_pseudo_inertia(p).topLeftCorner<3, 3>();
  const double size = p.segment<3>(kIxx).cwiseAbs().maxCoeff();
  static constexpr const char* kRule[3] = {"Iyy + Izz >= Ixx", "Ixx + Izz >= Iyy", "Ixx + Iyy >= Izz"};
  for (int j = 0; j < 3; ++j) {
    if (S(j, j) < -kRounding * size) {
      refuse_prior(body,
                   fmt::format("the triangle inequality {} is broken (Ixx {:g}, Iyy {:g}, Izz {:g} kg m^2)", kRule[j],
                               p(kIxx), p(kIyy), p(kIzz)),
                   "check the three inertias about the body frame's origin, and their units");
    }
  }
  const double smallest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(S, Eigen::EigenvaluesOnly).eigenvalues()(0);
  if (smallest < -kRounding * std::max(size, p.tail<3>().cwiseAbs().maxCoeff())) {
    refuse_prior(body, "the triangle inequality of its principal inertias is broken by the products of inertia",
                 "check the signs and sizes of Ixy, Iyz, Ixz");
  }
}

void check_has_mass(const std::string& body, double mass, double moments) {
  if (mass > 0) return;
  if (moments > 0) refuse_prior(body, "it has first moments but no mass", fmt::format("give {}.m a value", body));
}

/// A strictly consistent body next to p, or an error. The returned flag says that p had to be moved.
bool make_spatial_anchor(const std::string& body, Vector10& p) {
  check_mass_and_triangle(body, p);
  check_has_mass(body, p(kM), p.segment<3>(kMcx).cwiseAbs().maxCoeff());
  if (p.isZero(0)) refuse_prior(body, "every value is 0", "give at least its mass, or leave the body out");
  PseudoInertia<double> M = to_pseudo_inertia(p);
  const double size = std::max(M.topLeftCorner<3, 3>().trace(), p(kM) * kLength * kLength);
  if (is_physically_consistent(p, kRounding)) {
    for (int j = 0; j < 3; ++j) M(j, j) = std::max(M(j, j), kThin * size);  // as an earlier fit can have left it
    p = from_pseudo_inertia<double>(M);
    return false;
  }
  if (M(3, 3) <= 0) M(3, 3) = kInside * M.topLeftCorner<3, 3>().trace() / (kLength * kLength);
  // a matrix on the boundary becomes positive definite by any lift, one that is truly outside does not by so small a
  // one
  for (int j = 0; j < 3; ++j) M(j, j) = std::max(M(j, j), 0.0) + kInside * size;
  M(3, 3) *= 1 + kInside;
  const Vector10 lifted = from_pseudo_inertia<double>(M);
  if (!is_physically_consistent(lifted)) {
    refuse_prior(
        body, "the first moments are too large for its mass and inertia (m S must exceed (m c)^2 along every axis)",
        "give the inertias about the body frame's origin, not about the centre of mass, and check the moments");
  }
  p = lifted;
  return true;
}

/// In one plane: mass, two first moments, one inertia. Returns what was moved, or an empty text.
std::string make_planar_anchor(Block& block, const Vector10& prior) {
  Vector10& p = block.anchor;
  const int a = kMcx + block.axes[0], b = kMcx + block.axes[1];
  const char* inertia_name = kInertialNames[block.inertia];
  double mass = prior(kM), inertia = prior(block.inertia);
  const double moment = std::hypot(prior(a), prior(b));
  if (mass < 0) refuse_prior(block.name, fmt::format("its mass {:g} kg is negative", mass), "give a positive mass");
  if (inertia < 0) {
    refuse_prior(block.name, fmt::format("its inertia {} = {:g} kg m^2 is negative", inertia_name, inertia),
                 "give a positive one");
  }
  if (mass == 0 && inertia == 0 && moment == 0) refuse_prior(block.name, "every value is 0", "give at least its mass");
  check_has_mass(block.name, mass, moment);
  if (moment * moment > mass * inertia * (1 + kRounding)) {
    refuse_prior(block.name,
                 fmt::format("the first moments are too large: m {0} >= {1}^2 + {2}^2 is broken", inertia_name,
                             kInertialNames[a], kInertialNames[b]),
                 "give the inertia about the body frame's origin, not about the centre of mass, and check the moments");
  }
  std::string moved;
  if (inertia == 0) {
    inertia = kInside * mass * kLength * kLength;
    moved = "got a small inertia";
  }
  if (mass == 0) {
    mass = kInside * inertia / (kLength * kLength);
    moved = "got a small mass";
  }
  // With s = 0 (VI.a) the plane's axes are principal, which bounds the sum of the moments and not their norm.
  double shrink = 1;
  const double sum = std::abs(prior(a)) + std::abs(prior(b));
  if (sum * sum > (1 - kInside) * mass * inertia) {
    shrink = std::sqrt((1 - 0.02) * mass * inertia) / sum;
    moved = "starts with smaller first moments, because the reduced set cannot hold the prior's";
  }
  const double used = shrink * shrink * sum * sum / inertia;  // mass that the moments need at least
  if (block.fixed_alpha) block.mass_floor = std::min(mass / 10, (mass - used) / 2);

  const double third_prior =
      to_pseudo_inertia(prior)(3 - block.axes[0] - block.axes[1], 3 - block.axes[0] - block.axes[1]);
  double ma = shrink * prior(a), mb = shrink * prior(b);
  if (block.fixed_alpha && ma == 0 && mb == 0)
    ma = 1e-6 * std::sqrt(mass * inertia);  // alpha alone would hold the mass at its floor
  const double available = block.fixed_alpha ? mass - block.mass_floor : (mass + used) / 2;
  double Sa = inertia / 2;
  if (ma != 0 || mb != 0) Sa = split_inertia(available, ma, mb, inertia);
  // without a fixed alpha any split is allowed: prefer the prior's own
  if (!block.fixed_alpha) {
    const Eigen::Matrix4d M = to_pseudo_inertia(prior);
    const double Pa = M(block.axes[0], block.axes[0]), Pb = M(block.axes[1], block.axes[1]);
    if (Pa > 0 && Pb > 0 && ma * ma / Pa + mb * mb / Pb < (1 - kInside) * mass) Sa = Pa;
  }
  PseudoInertia<double> M = PseudoInertia<double>::Zero();
  M(3, 3) = mass;
  M(block.axes[0], 3) = ma;
  M(block.axes[1], 3) = mb;
  M(block.axes[0], block.axes[0]) = Sa;
  M(block.axes[1], block.axes[1]) = inertia - Sa;
  const int third = 3 - block.axes[0] - block.axes[1];
  M(third, third) = third_prior > kRounding * inertia ? third_prior : inertia / 2;
  p = from_pseudo_inertia<double>(M);
  return moved;
}

void make_point_anchor(Block& block, const Vector10& prior) {
  if (!(prior(kM) > 0)) {
    refuse_prior(block.name, fmt::format("its mass {:g} kg is not positive", prior(kM)),
                 fmt::format("give {}.m a value", block.name));
  }
  Vector10& p = block.anchor;
  p(kM) = prior(kM);
  p.segment<3>(kIxx) = prior.segment<3>(kIxx);
  if (!is_physically_consistent(p)) p.segment<3>(kIxx).setConstant(prior(kM) * kLength * kLength);
}

Eigen::Matrix4d symmetric(int row, int column, double value) {
  Eigen::Matrix4d out = Eigen::Matrix4d::Zero();
  out(row, column) = out(column, row) = value;
  return out;
}

void make_matrices(Block& block) {
  auto add_spatial = [&](LinearMatrix& matrix) {
    matrix.size = 4;
    for (const int entry : block.entries) matrix.basis.push_back(to_pseudo_inertia<double>(Vector10::Unit(entry)));
  };
  auto add_scalar = [&](LinearMatrix& matrix) {
    matrix.size = 1;
    matrix.basis = {symmetric(0, 0, 1)};
  };
  if (block.shape == BlockKind::spatial) {
    add_spatial(block.cone);
    add_spatial(block.metric);
  } else if (block.shape == BlockKind::planar) {
    // entries are: mass, first moment along each axis, inertia
    for (LinearMatrix* matrix : {&block.cone, &block.metric}) {
      // metric: diag(I, I) is the plane's own invariant, positive definite where m I > |m c|^2
      const double share = matrix == &block.cone ? 0.5 : 1.0;
      matrix->size = 3;
      matrix->basis = {symmetric(2, 2, 1), symmetric(0, 2, 1), symmetric(1, 2, 1),
                       symmetric(0, 0, share) + symmetric(1, 1, share)};
    }
    block.cone.basis.emplace_back(symmetric(0, 0, 0.5) + symmetric(1, 1, -0.5));
    block.cone.base(2, 2) = -block.mass_floor;
  } else if (block.shape != BlockKind::free) {
    add_scalar(block.cone);
    if (block.has_reference) add_scalar(block.metric);
  }
  if (block.metric.size == 0) return;
  const int n = block.metric.size;
  const Eigen::MatrixXd reference = block.metric(block.anchor(block.entries)).topLeftCorner(n, n);
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  block.metric_root.topLeftCorner(n, n) = dense::solve_upper(dense::cholesky(reference).L.transpose(), identity);
}

/// Sizes of the ten parameters that follow from mass and second moments, for entries whose prior is 0.
Vector10 natural_scale(const Vector10& anchor) {
  const PseudoInertia<double> M = to_pseudo_inertia(anchor);
  const auto root = [&](int i, int j) { return std::sqrt(M(i, i) * M(j, j)); };
  Vector10 scale;
  scale << M(3, 3), root(0, 3), root(1, 3), root(2, 3), anchor(kIxx), anchor(kIyy), anchor(kIzz), root(0, 1),
      root(1, 2), root(0, 2);
  // an inertia of 0 in a prior says "slender", not how slender
  const double slender = 0.01 * M.topLeftCorner<3, 3>().trace();
  scale.segment<3>(kIxx) = scale.segment<3>(kIxx).cwiseMax(slender);
  return scale;
}

void check_sizes(const ConsistentFitProblem& problem) {
  const auto P = static_cast<Eigen::Index>(problem.parameters.size());
  auto require = [](bool good, const std::string& what, const std::string& where) {
    if (!good) throw Error(what, "consistent fit, " + where, "give one entry for each parameter");
  };
  require(P > 0, "there are no parameters", "parameters");
  require(problem.A.cols() == P, fmt::format("{} columns for {} parameters", problem.A.cols(), P), "A");
  require(problem.A.rows() > 0 && problem.b.size() == problem.A.rows(),
          fmt::format("{} values for {} rows of A", problem.b.size(), problem.A.rows()), "b");
  require(problem.prior.size() == P, fmt::format("{} values for {} parameters", problem.prior.size(), P), "prior");
  require(problem.prior_std.size() == 0 || problem.prior_std.size() == P,
          fmt::format("{} values for {} parameters", problem.prior_std.size(), P), "prior_std");
  if (!problem.A.allFinite() || !problem.b.allFinite()) {
    throw Error("a value is not finite", "consistent fit, A or b", "look for gaps or overflows in the log");
  }
  for (Eigen::Index i = 0; i < P; ++i) {
    const std::string name = parameter_name(problem.parameters[static_cast<std::size_t>(i)]);
    if (!std::isfinite(problem.prior(i)))
      throw Error("the prior is not a finite number", "prior, " + name, "give a number");
    if (problem.prior_std.size() > 0 && !(problem.prior_std(i) > 0)) {
      throw Error("the prior's standard deviation must be positive", "prior, " + name, "give a number above 0");
    }
  }
}

Block make_body(const ConsistentFitProblem& problem, int column, ParameterSet set, Layout& layout) {
  ParameterId id = problem.parameters[static_cast<std::size_t>(column)];
  const Body body = id.body;
  const std::string name = owner_name(id);
  for (id.entry = 0; id.entry < kInertialParameters; ++id.entry) {
    const auto index = static_cast<std::size_t>(column + id.entry);
    if (index >= problem.parameters.size() || problem.parameters[index] != id) {
      throw Error(fmt::format("the ten parameters of body '{}' do not stand together, '{}' is not in its place", name,
                              quantity_name(id)),
                  "consistent fit, parameters", "keep the order m mcx mcy mcz Ixx Iyy Izz Ixy Iyz Ixz");
    }
  }
  const Vector10 prior = problem.prior.segment<10>(column);
  Block block;
  block.name = name;
  block.column = column;
  bool unseen_inertia = false;
  if (set == ParameterSet::full) {
    block.shape = BlockKind::spatial;
    block.entries = block.variables = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  } else {
    static_cast<Fitted&>(block) = reduction_of(body);
    block.fixed_alpha = body == Body::upper_arm;
    if (block.fixed_alpha) {
      // a carriage on a prismatic drive does not turn: only its mass is seen, as for the plate
      const auto seen = [&](int entry) { return problem.A.col(column + entry).cwiseAbs().maxCoeff() > 0; };
      if (seen(kM) && !seen(kMcx) && !seen(kMcz) && !seen(kIyy)) {
        block.shape = BlockKind::point;
        block.entries = {kM};
        block.variables = {log_cholesky::kAlpha};
        block.fixed_alpha = false;
      }
    }
    if (block.shape != BlockKind::spatial) {
      for (const int entry : {kIxx, kIyy, kIzz}) {
        const bool fitted = std::find(block.entries.begin(), block.entries.end(), entry) != block.entries.end();
        unseen_inertia = unseen_inertia || (!fitted && prior(entry) != 0);
      }
      // inertias that the motion does not show may be missing from a prior; given, they must make sense
      if (unseen_inertia) check_mass_and_triangle(name, prior);
    }
  }
  std::string moved;
  if (block.shape == BlockKind::spatial) {
    for (const int entry : block.entries) block.anchor(entry) = prior(entry);
    if (make_spatial_anchor(name, block.anchor))
      moved = "was on the boundary of what a body can have and starts a hair inside";
  } else if (block.shape == BlockKind::planar) {
    moved = make_planar_anchor(block, prior);
  } else {
    make_point_anchor(block, prior);
  }
  if (!moved.empty()) layout.notes.push_back(fmt::format("the prior of {} {}", name, moved));

  const Vector10 natural = natural_scale(block.anchor);
  for (int i = 0; i < 10; ++i) {
    layout.scale(column + i) = std::abs(prior(i)) > kTiny * natural(i) ? std::abs(prior(i)) : natural(i);
  }
  if (block.shape == BlockKind::planar) {
    // split into two halves, the moments' room is that of the inertia that is fitted
    for (const int axis : block.axes) {
      const double size = std::sqrt(block.anchor(kM) * block.anchor(block.inertia) / 2);
      if (!(std::abs(prior(kMcx + axis)) > kTiny * size)) layout.scale(column + kMcx + axis) = size;
    }
  }
  make_matrices(block);
  if (block.fixed_alpha) {
    // mass_floor = e^{2 alpha}: t is what is left, and the third axis takes no part
    const int a = block.axes[0], b = block.axes[1], third = 3 - a - b;
    const PseudoInertia<double> M = to_pseudo_inertia(block.anchor);
    const double c = block.mass_floor;
    block.pi(log_cholesky::kAlpha) = 0.5 * std::log(c);
    for (const int axis : {a, b, third}) block.pi(log_cholesky::kD1 + axis) = 0.5 * std::log(M(axis, axis) / c);
    for (const int axis : {a, b}) block.pi(log_cholesky::kT1 + axis) = M(axis, 3) / std::sqrt(M(axis, axis) * c);
  } else if (to_log_cholesky(block.anchor, block.pi) != Status::ok) {
    refuse_prior(name, "its pseudo-inertia is not positive definite", "check mass, first moments and inertias");
  }
  return block;
}

Block make_scalar(const ConsistentFitProblem& problem, int column, Layout& layout) {
  const ParameterId& id = problem.parameters[static_cast<std::size_t>(column)];
  const std::string name = parameter_name(id);
  Block block;
  block.name = name;
  block.column = column;
  block.entries = {0};
  if (id.kind != ParameterKind::offset) block.shape = BlockKind::positive;
  const double prior = problem.prior(column);
  if (block.shape == BlockKind::positive && prior < 0) {
    throw Error(fmt::format("the prior {:g} of '{}' is negative", prior, name), "prior, " + name,
                "friction and inertia only take energy: give 0 or a positive value");
  }
  // Without a prior the torque sets the scale: the value at which this effect alone made a tenth of all torque.
  const double column_norm = problem.A.col(column).norm();
  const double from_data = column_norm > 0 ? 0.1 * problem.b.norm() / column_norm : 1.0;
  const double scale = prior != 0 ? std::abs(prior) : (from_data > 0 ? from_data : 1.0);
  layout.scale(column) = scale;
  block.anchor(0) = block.shape == BlockKind::positive && prior == 0 ? 0.1 * scale : prior;
  block.has_reference = prior != 0;
  make_matrices(block);
  block.pi(0) = block.shape == BlockKind::positive ? std::log(block.anchor(0)) : block.anchor(0);
  return block;
}

}  // namespace

Eigen::Matrix4d LinearMatrix::operator()(const Eigen::Ref<const Eigen::VectorXd>& x) const {
  Eigen::Matrix4d sum = base;
  for (std::size_t i = 0; i < basis.size(); ++i) sum += x(static_cast<Eigen::Index>(i)) * basis[i];
  return sum;
}

Eigen::VectorXd Block::gather(const Eigen::VectorXd& x) const {
  Eigen::VectorXd own(fitted() + (split >= 0 ? 1 : 0));
  own.head(fitted()) = x.segment(y, fitted());
  if (split >= 0) own(fitted()) = x(split);
  return own;
}

double split_inertia(double mass, double a, double b, double inertia) {
  if (std::abs(b) > std::abs(a)) return inertia - split_inertia(mass, b, a, inertia);
  // mass Sa^2 - (a^2 - b^2 + mass I) Sa + a^2 I = 0, smaller root, in the form without cancellation
  const double half = 0.5 * (a * a - b * b + mass * inertia);
  const double discriminant = std::max(half * half - mass * a * a * inertia, 0.0);
  return a * a * inertia / (half + std::sqrt(discriminant));
}

Layout make_layout(const ConsistentFitProblem& problem, ParameterSet set) {
  check_sizes(problem);
  Layout layout;
  layout.parameters = static_cast<int>(problem.parameters.size());
  layout.scale.resize(layout.parameters);
  for (int column = 0; column < layout.parameters;) {
    const bool body = problem.parameters[static_cast<std::size_t>(column)].kind == ParameterKind::inertial;
    layout.blocks.push_back(body ? make_body(problem, column, set, layout) : make_scalar(problem, column, layout));
    column += body ? kInertialParameters : 1;
  }
  for (Block& block : layout.blocks) {
    block.y = layout.fitted;
    for (const int entry : block.entries) layout.y_to_p.push_back(block.column + entry);
    layout.fitted += block.fitted();
    layout.variables += block.is_body() ? static_cast<int>(block.variables.size()) : 1;
  }
  layout.convex = layout.fitted;
  for (Block& block : layout.blocks) {
    if (block.shape == BlockKind::planar) block.split = layout.convex++;
  }
  layout.prior = problem.prior(layout.y_to_p);
  return layout;
}

namespace {

/// What the first moments and products of inertia of a body must shrink by, so that it is clear of the boundary.
double shrink_to_inside(const Block& block, const Eigen::VectorXd& x) {
  constexpr double kClear = 0.05;  // smallest eigenvalue, the diagonal being 1; a uniform rod has 0.13
  if (block.shape != BlockKind::spatial && block.shape != BlockKind::planar) return 1;
  const int n = block.cone.size;
  const Eigen::MatrixXd M = block.cone(block.gather(x)).topLeftCorner(n, n);
  const Eigen::VectorXd root = M.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt();
  const double smallest = dense::eigenvalues(M.cwiseQuotient(root * root.transpose()))(0);
  return smallest >= kClear ? 1 : (1 - kClear) / (1 - smallest);
}

}  // namespace

Eigen::VectorXd convex_start(const Layout& layout) {
  Eigen::VectorXd x(layout.convex);
  for (const Block& block : layout.blocks) {
    x.segment(block.y, block.fitted()) = block.anchor(block.entries);
    if (block.split >= 0) {
      // in the middle of the splits that leave the mass room: Sa / Sb = |a| / |b|
      const double a = std::abs(block.anchor(kMcx + block.axes[0])), b = std::abs(block.anchor(kMcx + block.axes[1]));
      const double inertia = block.anchor(block.inertia), even = 1e-3 * (a + b) + 1e-12;
      x(block.split) = inertia * ((a + even) - (b + even)) / (a + b + 2 * even);
    }
    const double share = shrink_to_inside(block, x);
    for (int i = 0; share < 1 && i < block.fitted(); ++i) {
      const int entry = block.entries[static_cast<std::size_t>(i)];
      const bool moment = entry == kMcx || entry == kMcy || entry == kMcz;
      if (moment || entry == kIxy || entry == kIyz || entry == kIxz) x(block.y + i) *= share;
    }
  }
  return x;
}

LogCholeskyVector<double> variables_of(const Block& block, const Eigen::VectorXd& x) {
  LogCholeskyVector<double> pi = block.pi;
  if (block.shape == BlockKind::free || block.shape == BlockKind::positive) {
    pi(0) = block.shape == BlockKind::free ? x(block.y) : std::log(x(block.y));
  } else if (block.shape == BlockKind::point) {
    pi(log_cholesky::kAlpha) += 0.5 * std::log(x(block.y) / from_log_cholesky(pi)(kM));
  } else if (block.shape == BlockKind::spatial) {
    Vector10 p = Vector10::Zero();
    for (int i = 0; i < block.fitted(); ++i) p(block.entries[static_cast<std::size_t>(i)]) = x(block.y + i);
    if (to_log_cholesky(p, pi) != Status::ok) return block.pi;
  } else {
    const double mass = x(block.y), ma = x(block.y + 1), mb = x(block.y + 2), inertia = x(block.y + 3);
    double Sa = 0.5 * (inertia + x(block.split));
    double c = block.mass_floor;
    if (block.fixed_alpha) {
      if (ma == 0 && mb == 0) return block.pi;
      Sa = split_inertia(mass - c, ma, mb, inertia);
    } else {
      c = mass - ma * ma / Sa - mb * mb / (inertia - Sa);
      pi(log_cholesky::kAlpha) = 0.5 * std::log(c);
    }
    pi(log_cholesky::kD1 + block.axes[0]) = 0.5 * std::log(Sa / c);
    pi(log_cholesky::kD1 + block.axes[1]) = 0.5 * std::log((inertia - Sa) / c);
    pi(log_cholesky::kT1 + block.axes[0]) = ma / std::sqrt(Sa * c);
    pi(log_cholesky::kT1 + block.axes[1]) = mb / std::sqrt((inertia - Sa) * c);
  }
  return pi;
}

}  // namespace deltadyn::fit
