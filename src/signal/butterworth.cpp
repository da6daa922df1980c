#include "deltadyn/signal/butterworth.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

using Eigen::Index;
using std::numbers::pi;

constexpr int kLargestOrder = 12;

void demand(bool fine, const char* rule, const char* mend) {
  if (!fine) throw Error(rule, "low pass", mend, ExitCode::usage);
}

void check(double sample_rate_hz, double cutoff_hz, int order) {
  demand(sample_rate_hz > 0 && std::isfinite(sample_rate_hz), "the sample rate must be positive",
         "give a positive rate in Hz");
  demand(cutoff_hz > 0, "the cut-off must be positive", "give a positive frequency in Hz");
  demand(order >= 1 && order <= kLargestOrder, "the order of the filter must be 1 to 12", "4 serves most logs");
}

/// Transposed direct form II.
void pass(const std::vector<SecondOrderSection>& sections, Eigen::Ref<Eigen::VectorXd> x) {
  const double first = x(0);
  for (const SecondOrderSection& section : sections) {
    // The state that a constant input leaves unchanged: every section has unit gain, so its output is the input.
    double s2 = (section.b2 - section.a2) * first, s1 = (section.b1 - section.a1) * first + s2;
    for (Index i = 0; i < x.size(); ++i) {
      const double in = x(i);
      const double out = section.b0 * in + s1;
      s1 = section.b1 * in - section.a1 * out + s2;
      s2 = section.b2 * in - section.a2 * out;
      x(i) = out;
    }
  }
}

}  // namespace

std::vector<SecondOrderSection> butterworth_low_pass(double sample_rate_hz, double cutoff_hz, int order) {
  check(sample_rate_hz, cutoff_hz, order);
  demand(cutoff_hz < 0.5 * sample_rate_hz, "the cut-off must be below half the sample rate", "choose a lower cut-off");
  const double w = std::tan(pi * cutoff_hz / sample_rate_hz);  // pre-warped, s = (z - 1)/(z + 1)
  std::vector<SecondOrderSection> sections;
  for (int k = 0; k < order / 2; ++k) {
    // The analog pole pair s^2 + 2 zeta w s + w^2.
    const double zeta = std::sin(pi * (2.0 * k + 1.0) / (2.0 * order));
    const double scale = 1.0 / (1.0 + 2.0 * zeta * w + w * w);
    sections.push_back({w * w * scale, 2.0 * w * w * scale, w * w * scale, 2.0 * (w * w - 1.0) * scale,
                        (1.0 - 2.0 * zeta * w + w * w) * scale});
  }
  if (order % 2 == 1) sections.push_back({w / (1.0 + w), w / (1.0 + w), 0.0, (w - 1.0) / (1.0 + w), 0.0});
  return sections;
}

double zero_phase_gain(const std::vector<SecondOrderSection>& sections, double sample_rate_hz, double frequency_hz) {
  const std::complex<double> delay = std::polar(1.0, -2.0 * pi * frequency_hz / sample_rate_hz);
  double gain = 1.0;
  for (const SecondOrderSection& s : sections) {
    gain *= std::norm((s.b0 + delay * (s.b1 + delay * s.b2)) / (1.0 + delay * (s.a1 + delay * s.a2)));
  }
  return gain;
}

double single_pass_cutoff_hz(double sample_rate_hz, double cutoff_hz, int order) {
  check(sample_rate_hz, cutoff_hz, order);
  // |H|^4 = 1/2, with |H|^2 = 1 / (1 + (w/wc)^(2 n)) in the warped frequency w.
  const double w = std::tan(pi * cutoff_hz / sample_rate_hz) * std::pow(std::numbers::sqrt2 - 1.0, -0.5 / order);
  return std::atan(w) * sample_rate_hz / pi;
}

Eigen::MatrixXd zero_phase_filter(const Eigen::Ref<const Eigen::MatrixXd>& columns, double sample_rate_hz,
                                  double cutoff_hz, int order) {
  check(sample_rate_hz, cutoff_hz, order);
  const Index n = columns.rows();
  if (n < 2 || columns.cols() == 0 || cutoff_hz >= 0.5 * sample_rate_hz) return columns;
  const auto sections =
      butterworth_low_pass(sample_rate_hz, single_pass_cutoff_hz(sample_rate_hz, cutoff_hz, order), order);
  // The slowest pole has died out after a few times the period of the cut-off.
  const auto wanted_padding = static_cast<Index>(std::ceil(0.8 * (1 + order) * sample_rate_hz / cutoff_hz));
  const Index padding = std::clamp<Index>(wanted_padding, 1, n - 1);
  Eigen::MatrixXd result(n, columns.cols());
  Eigen::VectorXd x(n + 2 * padding);
  for (Index c = 0; c < columns.cols(); ++c) {
    const auto column = columns.col(c);
    for (Index i = 0; i < padding; ++i) {
      x(i) = 2.0 * column(0) - column(padding - i);
      x(n + padding + i) = 2.0 * column(n - 1) - column(n - 2 - i);
    }
    x.segment(padding, n) = column;
    pass(sections, x);
    x.reverseInPlace();
    pass(sections, x);
    result.col(c) = x.segment(padding, n).reverse();
  }
  return result;
}

}  // namespace deltadyn
