#include "search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlopt.hpp>
#include <vector>

namespace deltadyn::detail {
namespace {

constexpr double kConstraintTolerance = 1e-6;
constexpr double kRelativeTolerance = 1e-7;
constexpr double kLeastGain = 1e-3;    // of a restart that is followed by another one
constexpr double kPenaltyValue = 1e4;  // where the motion cannot be evaluated
constexpr double kPenaltyConstraint = 10;

/// NLopt asks for value and constraints one after the other; both come from one evaluation.
class Evaluator {
 public:
  Evaluator(const DesignProblem& problem, const std::function<bool()>& stop, nlopt::opt& optimizer)
      : problem_(problem), stop_(stop), optimizer_(optimizer) {}

  void at(unsigned n, const double* x) {
    const Eigen::Map<const Eigen::VectorXd> v(x, static_cast<Eigen::Index>(n));
    if (evaluations_ > 0 && v == last_) return;
    last_ = v;
    if (stop_()) optimizer_.force_stop();
    problem_.evaluate(last_, true, e_);
    ++evaluations_;
    if (!e_.regular) return;
    // To bring a load of 1 + c back to 1 the amplitudes shrink by c, and so do the torques: log det M falls by 2 p c.
    const double excess = std::max(0.0, e_.worst - 1);
    const double rating = e_.value - 2.0 * static_cast<double>(e_.information.rows()) *
                                         (std::log1p(excess) + kPriceOfReversals * e_.lacks_away);
    if (rating > best_rating_) {
      best_rating_ = rating;
      best_ = last_;
    }
  }

  static double value(unsigned n, const double* x, double* gradient, void* self_) {
    auto& self = *static_cast<Evaluator*>(self_);
    self.at(n, x);
    const bool regular = self.e_.regular;
    if (gradient != nullptr) {
      for (unsigned k = 0; k < n; ++k) gradient[k] = regular ? -self.e_.gradient(static_cast<Eigen::Index>(k)) : 0.0;
    }
    return regular ? -self.e_.value : kPenaltyValue;
  }

  static void constraints(unsigned m, double* values, unsigned n, const double* x, double* gradient, void* self_) {
    auto& self = *static_cast<Evaluator*>(self_);
    self.at(n, x);
    if (!self.e_.regular) {
      std::fill(values, values + m, kPenaltyConstraint);
      if (gradient != nullptr) std::fill(gradient, gradient + static_cast<std::size_t>(m) * n, 0.0);
      return;
    }
    std::copy_n(self.e_.constraints.data(), m, values);
    // NLopt stores row after row, one a constraint: the columns of our matrix.
    if (gradient != nullptr) std::copy_n(self.e_.jacobian.data(), static_cast<std::size_t>(m) * n, gradient);
  }

  [[nodiscard]] int evaluations() const { return evaluations_; }
  [[nodiscard]] const Eigen::VectorXd& best() const { return best_; }
  [[nodiscard]] double best_rating() const { return best_rating_; }

 private:
  const DesignProblem& problem_;
  const std::function<bool()>& stop_;
  nlopt::opt& optimizer_;
  Eigen::VectorXd last_, best_;
  DesignProblem::Evaluation e_;
  double best_rating_ = -std::numeric_limits<double>::infinity();
  int evaluations_ = 0;
};

}  // namespace

SearchResult local_search(const DesignProblem& problem, const Eigen::VectorXd& start, int evaluations,
                          const std::function<bool()>& stop) {
  const auto n = static_cast<unsigned>(start.size());
  nlopt::opt optimizer(nlopt::LD_SLSQP, n);
  Evaluator evaluator(problem, stop, optimizer);
  std::vector<double> lower(n, -HUGE_VAL), upper(n, HUGE_VAL), x(start.data(), start.data() + start.size());
  const bool fixed_frequency = !(problem.settings().highest_hz > problem.settings().lowest_hz);
  lower.back() = 0;
  upper.back() = fixed_frequency ? 0 : 1;
  x.back() = std::clamp(x.back(), lower.back(), upper.back());
  optimizer.set_lower_bounds(lower);
  optimizer.set_upper_bounds(upper);
  optimizer.set_min_objective(&Evaluator::value, &evaluator);
  optimizer.add_inequality_mconstraint(
      &Evaluator::constraints, &evaluator,
      std::vector<double>(static_cast<std::size_t>(problem.constraints()), kConstraintTolerance));
  optimizer.set_ftol_rel(kRelativeTolerance);
  // A run that ended early, because its picture of the curvature had gone stale, is taken up from where it came to.
  double before = -std::numeric_limits<double>::infinity();
  while (evaluator.evaluations() < evaluations && !stop()) {
    optimizer.set_maxeval(evaluations - evaluator.evaluations());
    double value = 0;
    try {
      optimizer.optimize(x, value);
    } catch (const nlopt::roundoff_limited&) {  // the point reached is as good as numbers allow
    } catch (const nlopt::forced_stop&) {
      break;
    } catch (const std::runtime_error&) {  // NLopt's general failure: no descent from here
      break;
    }
    // Where nothing can be evaluated the rating stays minus infinity, and there is no slope to follow either.
    if (!(evaluator.best_rating() >= before + kLeastGain) || !std::isfinite(evaluator.best_rating())) break;
    before = evaluator.best_rating();
  }
  return {evaluator.best().size() > 0 ? evaluator.best() : start, evaluator.evaluations()};
}

}  // namespace deltadyn::detail
