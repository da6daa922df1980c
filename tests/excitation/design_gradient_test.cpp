// The whole of the optimisation problem against automatic differentiation: objective (9) with every criterion and the
// velocity term, and the limits (10), (11). The oracle is written from the definitions in Eigen's AutoDiffScalar; of
// the product it takes the kinematics and the regressor, in its own numbers (which tests/dynamics checks against
// Lagrange's equations), and the scales of the variables.

#include <Eigen/Core>
#include <cmath>
#include <gmock/gmock.h>
#include <numbers>
#include <unsupported/Eigen/AutoDiff>
#include <vector>

#include "deltadyn/dynamics/regressor.hpp"
#include "deltadyn/runtime/geometry_of.hpp"
#include "deltadyn/runtime/layout_columns.hpp"

#include "../../src/excitation/design_problem.hpp"
#include "../../src/excitation/search.hpp"
#include "excitation/excitation_setup.hpp"
#include "support/random_robot.hpp"

namespace deltadyn::detail {
namespace {

using testing_support::excitation_setup;
using testing_support::ExcitationSetup;
using testing_support::Random;

constexpr int kHarmonics = 3, kSamples = 60;
constexpr Criterion kCriteria[] = {Criterion::log_det, Criterion::det, Criterion::cond, Criterion::trace,
                                   Criterion::min_eigenvalue};

template <class R>
class DesignGradient : public ::testing::Test {
 public:
  static constexpr int N = R::kDrives, kTerms = 1 + 2 * kHarmonics, kVariables = kTerms * N + 1;
  using Number = Eigen::AutoDiffScalar<Eigen::Matrix<double, kVariables, 1>>;
  using Numbers = std::vector<Number>;
  using Square = std::vector<Numbers>;
  using Layout = ParameterLayout<R, Limbs::shared>;

  struct Definition {
    Square M;             ///< information a sample
    Number rms;           ///< of the drive velocities in units of their limits
    Numbers constraints;  ///< as Evaluation::constraints
  };

  DesignGradient() : setup(excitation_setup(R::kName, 300)), limits(*setup.limits) {
    limits.parameters = Eigen::VectorXd::LinSpaced(setup.robot->parameters(), 0.05, 0.2);
    limits.tau = Eigen::VectorXd::Constant(N, 60);
    // One shape of the workspace a robot: half ball, cone and box.
    if (std::string(R::kName) == Delta3::kName) {
      limits.region->shape = RegionShape::cone;
      limits.region->height = limits.region->radius;
      limits.region->top_radius = 0.7 * limits.region->radius;
    } else if (std::string(R::kName) == LinearDelta3::kName) {
      limits.region->shape = RegionShape::box;
      limits.region->size = Eigen::Vector3d(1.1, 1.2, 1.0) * limits.region->radius;
    }
  }

  [[nodiscard]] ProblemSettings settings(Criterion criterion, bool beside_another) const {
    ProblemSettings s;
    s.criterion = criterion;
    s.velocity_weight = 1.5;
    s.harmonics = kHarmonics;
    s.samples = kSamples;
    if (beside_another) {
      const int p = setup.space.base_parameters();
      s.share = 0.4;
      // Apart from each other, so that the power method of the oracle finds the extreme eigenvalues soon.
      Eigen::VectorXd diagonal(p);
      for (int k = 0; k < p; ++k) diagonal(k) = 0.01 * std::pow(1.3, k);
      s.other_information = diagonal.asDiagonal();
      s.other_information(0, 1) = s.other_information(1, 0) = 0.005;
    }
    return s;
  }

  /// A point on the way of a search, where the information is regular and limits bind or are broken.
  [[nodiscard]] Eigen::VectorXd point(std::uint64_t seed, int evaluations) const {
    const DesignProblem problem(setup.space, limits, settings(Criterion::log_det, false));
    Random random(seed);
    Eigen::VectorXd v(problem.variables());
    for (Eigen::Index k = 0; k < v.size(); ++k) v(k) = 0.15 * random.uniform(-1, 1);
    v(v.size() - 1) = random.uniform(0.3, 0.8);
    FourierSeries series = problem.series(v);
    series.coefficients.row(0) = setup.space.states.centre.transpose();
    return local_search(problem, problem.variables_of(series), evaluations, [] { return false; }).best;
  }

  /// Width of the smooth Coulomb sign: a share of the rates' half width, sqrt 3 times the root mean square of 200
  /// states.
  [[nodiscard]] Eigen::VectorXd sign_width(double share) const {
    Eigen::VectorXd q(N), qd(N), qdd(N), squares = Eigen::VectorXd::Zero(N);
    for (Eigen::Index k = 0; k < 200; ++k) {
      const Eigen::VectorXd x = setup.space.states.x.col(k);
      EXPECT_EQ(setup.robot->to_drives({x.head(N), x.segment(N, N), x.tail(N)}, q, qd, qdd), Status::ok);
      squares += qd.cwiseAbs2();
    }
    Eigen::VectorXd width = Eigen::VectorXd::Constant(Layout::kFrictionJoints, setup.space.rate_scale(0));
    width.head(N) = (3 * squares / 200).cwiseSqrt();
    return share * width;
  }

  [[nodiscard]] Number usage(const Limit& limit, const Vector<Number, N>& z, const Vector<Number, N>& zd,
                             const Vector<Number, N>& zdd, const Motion<Number, R>& motion,
                             const Vector<Number, N>& torque) const {
    const int k = limit.index;
    Number value(0);
    switch (limit.quantity) {
      case LimitedQuantity::z: value = z(k); break;
      case LimitedQuantity::zd: value = zd(k); break;
      case LimitedQuantity::zdd: value = zdd(k); break;
      case LimitedQuantity::q: value = motion.posture.q(k); break;
      case LimitedQuantity::qd: value = motion.qd(k); break;
      case LimitedQuantity::qdd: value = motion.qdd(k); break;
      case LimitedQuantity::tau: value = torque(k); break;
      case LimitedQuantity::region: return wall(limit.index, z);
    }
    return (value - Number((limit.upper + limit.lower) / 2)) / Number((limit.upper - limit.lower) / 2);
  }

  /// 1 on the wall of the workspace, less inside.
  [[nodiscard]] Number wall(int wall, const Vector<Number, N>& z) const {
    const Region& region = *limits.region;
    Number d[3];
    for (int i = 0; i < 3; ++i) d[i] = z(i) - Number(region.centre(i));
    switch (region.shape) {
      case RegionShape::half_ball: {
        if (wall == 1) return Number(1) + d[2] / Number(region.radius);
        return (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / Number(region.radius * region.radius);
      }
      case RegionShape::cone: {
        if (wall > 0) return Number(wall == 1 ? 2 / region.height : -2 / region.height) * d[2];
        const Number up = d[2] / Number(region.height) + Number(0.5);
        const Number radius = Number(region.radius) + up * Number(region.top_radius - region.radius);
        return (d[0] * d[0] + d[1] * d[1]) / (radius * radius);
      }
      default: return Number((wall % 2 == 0 ? 2 : -2) / region.size(wall / 2)) * d[wall / 2];
    }
  }

  [[nodiscard]] Definition definition(const Eigen::VectorXd& v) const {
    const ProblemSettings s = settings(Criterion::log_det, false);
    const DesignProblem problem(setup.space, limits, s);
    // Coefficients are the variables times their scales; the frequency runs from the lowest to the highest.
    const Eigen::MatrixXd scale = problem.series(Eigen::VectorXd::Ones(kVariables)).coefficients;
    const auto variable = [&v](int k) { return Number(v(k), kVariables, k); };
    const Number omega = Number(2 * std::numbers::pi) *
                         (Number(s.lowest_hz) + Number(s.highest_hz - s.lowest_hz) * variable(kVariables - 1));
    const auto geometry = geometry_of<Number, R>(setup.robot->description());
    const auto columns = layout_columns<R, Limbs::shared>(setup.robot->parameter_options());
    const Eigen::VectorXd width = sign_width(s.sign_share);
    const auto list = limits.list(setup.robot->description());
    const auto p = setup.space.base_columns.size();

    Definition out{Square(p, Numbers(p, Number(0))), Number(0), {}};
    std::vector<Numbers> usages(list.size());
    for (int i = 0; i < kSamples; ++i) {
      const double phase = 2 * std::numbers::pi * i / kSamples;
      Vector<Number, N> z, zd, zdd;
      for (int c = 0; c < N; ++c) {
        z(c) = variable(c * kTerms) * Number(scale(0, c));
        zd(c) = zdd(c) = Number(0);
        for (int k = 1; k <= kHarmonics; ++k) {
          const Number a = variable(c * kTerms + 2 * k - 1) * Number(scale(2 * k - 1, c));
          const Number b = variable(c * kTerms + 2 * k) * Number(scale(2 * k, c));
          const Number sine(std::sin(k * phase)), cosine(std::cos(k * phase)), rate = Number(k) * omega;
          z(c) += a * sine + b * cosine;
          zd(c) += rate * (a * cosine - b * sine);
          zdd(c) -= rate * rate * (a * sine + b * cosine);
        }
      }
      Motion<Number, R> motion;
      EXPECT_EQ(motion_from_task(geometry, z, zd, zdd, motion), Status::ok);
      Matrix<Number, N, Layout::kColumns> Y;
      deltadyn::regressor<Layout>(geometry, motion, Y);
      for (int joint = 0; joint < Layout::kFrictionJoints; ++joint) {
        const auto f = friction_joint(motion, joint);
        const Number size = sqrt(Number(f.rate * f.rate + Number(width(joint) * width(joint))));
        for (int drive = 0; drive < N; ++drive) Y(drive, Layout::coulomb(joint)) = f.rate / size * f.J(drive);
      }
      Vector<Number, N> torque;
      for (int drive = 0; drive < N; ++drive) {
        torque(drive) = Number(0);
        for (std::size_t k = 0; k < columns.size(); ++k)
          torque(drive) += Number(limits.parameters(static_cast<Eigen::Index>(k))) * Y(drive, columns[k]);
        const Number share = motion.qd(drive) / Number(limits.qd(drive));
        out.rms += share * share / Number(kSamples);
        Numbers row(p);
        for (std::size_t k = 0; k < p; ++k) {
          const auto column = columns[static_cast<std::size_t>(setup.space.base_columns[k])];
          row[k] = Y(drive, column) /
                   Number(setup.space.torque_scale(drive) * setup.space.column_scale(static_cast<Eigen::Index>(k)));
        }
        for (std::size_t a = 0; a < p; ++a)
          for (std::size_t b = 0; b <= a; ++b) out.M[a][b] += row[a] * row[b] / Number(kSamples);
      }
      for (std::size_t k = 0; k < list.size(); ++k) usages[k].push_back(usage(list[k], z, zd, zdd, motion, torque));
    }
    for (std::size_t a = 0; a < p; ++a)
      for (std::size_t b = 0; b < a; ++b) out.M[b][a] = out.M[a][b];
    out.rms = sqrt(out.rms);
    for (std::size_t k = 0; k < list.size(); ++k) {
      for (int w = 0; w < s.windows; ++w) {
        Number sum(0);
        for (int i = w * kSamples / s.windows; i < (w + 1) * kSamples / s.windows; ++i) {
          const Number up = Number(s.sharpness) * usages[k][static_cast<std::size_t>(i)];
          sum += exp(up);
          if (list[k].quantity != LimitedQuantity::region) sum += exp(Number(-up));
        }
        out.constraints.push_back(log(sum) / Number(s.sharpness) - Number(1));
      }
    }
    return out;
  }

  static Square cholesky(const Square& M) {
    Square L(M.size(), Numbers(M.size(), Number(0)));
    for (std::size_t j = 0; j < M.size(); ++j) {
      for (std::size_t i = j; i < M.size(); ++i) {
        Number rest = M[i][j];
        for (std::size_t k = 0; k < j; ++k) rest -= L[i][k] * L[j][k];
        L[i][j] = i == j ? Number(sqrt(rest)) : Number(rest / L[j][j]);
      }
    }
    return L;
  }
  static Numbers solve(const Square& L, Numbers b) {
    for (std::size_t i = 0; i < b.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) b[i] -= L[i][k] * b[k];
      b[i] /= L[i][i];
    }
    for (std::size_t i = b.size(); i-- > 0;) {
      for (std::size_t k = i + 1; k < b.size(); ++k) b[i] -= L[k][i] * b[k];
      b[i] /= L[i][i];
    }
    return b;
  }
  static Numbers product(const Square& M, const Numbers& x) {
    Numbers y(x.size(), Number(0));
    for (std::size_t i = 0; i < x.size(); ++i)
      for (std::size_t k = 0; k < x.size(); ++k) y[i] += M[i][k] * x[k];
    return y;
  }
  static Number dot(const Numbers& a, const Numbers& b) {
    Number sum(0);
    for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
    return sum;
  }
  /// Largest eigenvalue of the map by the power method, every step differentiated.
  template <class Map>
  static Number largest_eigenvalue(std::size_t p, Map map) {
    Numbers x(p);
    for (std::size_t k = 0; k < p; ++k) x[k] = Number(std::cos(static_cast<double>(k * k)));
    Number value(0);
    for (int step = 0; step < 1500; ++step) {
      const Numbers y = map(x);
      const Number before = value;
      value = dot(x, y) / dot(x, x);
      const Number length = sqrt(dot(y, y));
      for (std::size_t k = 0; k < p; ++k) x[k] = y[k] / length;
      const double change = (value.derivatives() - before.derivatives()).cwiseAbs().maxCoeff();
      if (step > 20 && change < 1e-13 * value.derivatives().cwiseAbs().maxCoeff()) break;
    }
    return value;
  }
  static Number criterion(Criterion which, const Square& M) {
    const auto p = static_cast<double>(M.size());
    const Square L = cholesky(M);
    if (which == Criterion::log_det || which == Criterion::det) {
      Number sum(0);
      for (std::size_t k = 0; k < M.size(); ++k) sum += Number(2) * log(L[k][k]);
      return which == Criterion::det ? Number(exp(Number(sum / Number(p)))) : sum;
    }
    if (which == Criterion::trace) {
      Number sum(0);
      for (std::size_t k = 0; k < M.size(); ++k) {
        Numbers unit(M.size(), Number(0));
        unit[k] = Number(1);
        sum += solve(L, unit)[k];
      }
      return -log(sum);
    }
    const Number least = Number(1) / largest_eigenvalue(M.size(), [&L](const Numbers& x) { return solve(L, x); });
    if (which == Criterion::min_eigenvalue) return log(least);
    return log(Number(least / largest_eigenvalue(M.size(), [&M](const Numbers& x) { return product(M, x); })));
  }

  ExcitationSetup setup;
  MotionLimits limits;
};

using Robots = ::testing::Types<Delta3, LinearDelta3, Delta4>;
TYPED_TEST_SUITE(DesignGradient, Robots);

TYPED_TEST(DesignGradient, OfObjectiveAndLimitsIsThatOfAutomaticDifferentiation) {
  using Auto = typename TestFixture::Number;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Eigen::VectorXd v = this->point(seed, seed == 1 ? 60 : 20);
    const auto defined = this->definition(v);
    for (const bool beside_another : {false, true}) {
      for (const Criterion which : kCriteria) {
        const ProblemSettings s = this->settings(which, beside_another);
        const DesignProblem problem(this->setup.space, this->limits, s);
        DesignProblem::Evaluation e;
        problem.evaluate(v, true, e);
        ASSERT_TRUE(e.regular);
        auto M = defined.M;
        for (std::size_t a = 0; a < M.size(); ++a) {
          for (std::size_t b = 0; b < M.size(); ++b) {
            M[a][b] *= Auto(s.share);
            if (beside_another)
              M[a][b] += Auto(s.other_information(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)));
          }
        }
        const Auto value = this->criterion(which, M) + Auto(s.velocity_weight) * defined.rms;
        const double size = value.derivatives().cwiseAbs().maxCoeff();
        const double error = (e.gradient - value.derivatives()).cwiseAbs().maxCoeff() / size;
        EXPECT_NEAR(e.value, value.value(), 1e-9 * std::abs(value.value())) << word_of(which);
        EXPECT_LT(error, 1e-9) << word_of(which) << ", point " << seed;
        this->RecordProperty(
            std::string(word_of(which)) + "_" + std::to_string(seed) + (beside_another ? "_beside" : ""),
            std::to_string(error * 1e12) + "e-12");

        ASSERT_EQ(static_cast<std::size_t>(e.constraints.size()), defined.constraints.size());
        double worst = 0;
        for (std::size_t k = 0; k < defined.constraints.size(); ++k) {
          const auto at = static_cast<Eigen::Index>(k);
          const auto& slope = defined.constraints[k].derivatives();
          EXPECT_NEAR(e.constraints(at), defined.constraints[k].value(), 1e-9);
          worst = std::max(worst, (e.jacobian.col(at) - slope).cwiseAbs().maxCoeff() / slope.cwiseAbs().maxCoeff());
        }
        EXPECT_LT(worst, 1e-9) << "limits, point " << seed;
        this->RecordProperty("limits_" + std::to_string(seed), std::to_string(worst * 1e12) + "e-12");
      }
    }
  }
}

}  // namespace
}  // namespace deltadyn::detail
