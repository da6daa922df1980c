#include "deltadyn/simulation/reference_motion.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

/// Polynomial of fifth degree over h with both ends' values and two derivatives; s in [0, 1].
struct Quintic {
  double a0, a1, a2, a3, a4, a5, h;
  Quintic(double x0, double v0, double w0, double x1, double v1, double w1, double length) : h(length) {
    const double d = x1 - x0 - v0 * h - 0.5 * w0 * h * h;
    const double dv = (v1 - v0 - w0 * h) * h;
    const double dw = (w1 - w0) * h * h;
    a0 = x0;
    a1 = v0 * h;
    a2 = 0.5 * w0 * h * h;
    a3 = 10 * d - 4 * dv + 0.5 * dw;
    a4 = -15 * d + 7 * dv - dw;
    a5 = 6 * d - 3 * dv + 0.5 * dw;
  }
  [[nodiscard]] double value(double s) const { return a0 + s * (a1 + s * (a2 + s * (a3 + s * (a4 + s * a5)))); }
  [[nodiscard]] double rate(double s) const {
    return (a1 + s * (2 * a2 + s * (3 * a3 + s * (4 * a4 + s * 5 * a5)))) / h;
  }
  [[nodiscard]] double acceleration(double s) const {
    return (2 * a2 + s * (6 * a3 + s * (12 * a4 + s * 20 * a5))) / (h * h);
  }
};

}  // namespace

ReferenceMotion::ReferenceMotion(const TrajectorySamples& samples, int repeats)
    : q_(samples.q), qd_(samples.qd), qdd_(samples.qdd), repeats_(repeats), period_(0) {
  const Eigen::Index n = samples.samples();
  if (n < 2) throw Error("a trajectory needs two samples at least", samples.file, "");
  if (repeats < 1)
    throw Error("a trajectory runs once or more often", samples.file, "give --repeat 1 or more", ExitCode::usage);
  t_ = samples.t_s.array() - samples.t_s(0);
  const double step = t_(n - 1) - t_(n - 2);
  period_ = t_(n - 1);
  if (repeats == 1) return;
  // The end may be the start written once more, or the sample before it.
  const auto mismatch = [&](double gap) {
    const Eigen::RowVectorXd reached = q_.row(n - 1) + gap * qd_.row(n - 1) + 0.5 * gap * gap * qdd_.row(n - 1);
    return (reached - q_.row(0)).cwiseAbs().maxCoeff();
  };
  const double range = std::max(1e-9, (q_.colwise().maxCoeff() - q_.colwise().minCoeff()).maxCoeff());
  const bool closed = mismatch(0) < 1e-6 * range;
  if (!closed) {
    if (mismatch(step) > 1e-3 * range) {
      throw Error(
          fmt::format("the trajectory does not end where it begins ({:.3g} rad or m apart), so it cannot be repeated",
                      mismatch(step)),
          samples.file, "leave out --repeat, or plan with delta-excite --periodic", ExitCode::usage);
    }
    period_ += step;
    for (Eigen::MatrixXd* m : {&q_, &qd_, &qdd_}) {
      m->conservativeResize(n + 1, Eigen::NoChange);
      m->row(n) = m->row(0).eval();
    }
    t_.conservativeResize(n + 1);
    t_(n) = period_;
  }
}

void ReferenceMotion::at(double time, State& state) const {
  const Eigen::Index n = t_.size();
  const int count = drives();
  for (Eigen::VectorXd* v : {&state.q, &state.qd, &state.qdd}) v->resize(count);
  double t = time;
  if (repeats_ > 1) {
    // The end of the last run belongs to it, not to one more.
    const double run = std::min(std::floor(t / period_ + 1e-12), static_cast<double>(repeats_ - 1));
    t -= run * period_;
  }
  constexpr double kSame = 1e-9;  // share of a sample: times come from sums of decimal fractions
  if (t < t_(0) || t > t_(n - 1) + kSame) {
    const Eigen::Index end = t < t_(0) ? 0 : n - 1;
    state.q = q_.row(end);
    state.qd.setZero();
    state.qdd.setZero();
    return;
  }
  const double* first = t_.data();
  auto k = static_cast<Eigen::Index>(std::upper_bound(first, first + n, t) - first) - 1;
  k = std::clamp<Eigen::Index>(k, 0, n - 2);
  const double h = t_(k + 1) - t_(k), s = (t - t_(k)) / h;
  const Eigen::Index same = s < kSame ? k : (s > 1 - kSame ? k + 1 : -1);
  if (same >= 0) {
    state.q = q_.row(same);
    state.qd = qd_.row(same);
    state.qdd = qdd_.row(same);
    return;
  }
  for (int j = 0; j < count; ++j) {
    const Quintic x(q_(k, j), qd_(k, j), qdd_(k, j), q_(k + 1, j), qd_(k + 1, j), qdd_(k + 1, j), h);
    state.q(j) = x.value(s);
    state.qd(j) = x.rate(s);
    state.qdd(j) = x.acceleration(s);
  }
}

}  // namespace deltadyn
