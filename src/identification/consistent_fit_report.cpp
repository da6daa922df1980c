#include <fmt/format.h>
#include <iterator>

#include "deltadyn/identification/consistent_fit.hpp"

namespace deltadyn {

std::string ConsistentFitSummary::brief_report() const {
  const std::string proof = !certificate.available ? "no certificate for this metric"
                            : certificate.passed ? fmt::format("global optimum within {:.1e} of chi^2", certificate.gap)
                                                 : fmt::format("not proven optimal (gap {:.2e})", certificate.gap);
  return fmt::format(
      "consistent fit: {} variables, chi^2 {:.6g} (prior {:.3g}), lambda {:.3g}{}, {} after {} + {} iterations, {:.1f} "
      "ms, {}",
      variables, data_cost, initial_data_cost, lambda, lambda_from_data ? " from the data" : "",
      converged ? "converged" : "NOT converged", interior_point_iterations, iterations, 1e3 * solve_time_s, proof);
}

std::string ConsistentFitSummary::full_report() const {
  std::string text = brief_report() + "\n";
  auto out = std::back_inserter(text);
  if (lambda_from_data)
    fmt::format_to(out, "chi^2 {:.6g} against its minimum {:.6g} on the consistent set\n", data_cost, data_cost_min);
  if (certificate.available) {
    fmt::format_to(
        out, "certificate: smallest dual eigenvalue {:.2e} ({}), complementarity {:.2e}, gap {:.2e}, relative {:.2e}\n",
        certificate.min_dual_eigenvalue, certificate.min_dual_name, certificate.complementarity, certificate.gap,
        certificate.relative_gap);
  }
  fmt::format_to(out, "Ceres: {}\n", message);
  for (const std::string& note : notes) fmt::format_to(out, "note: {}\n", note);
  fmt::format_to(out, "{:<24}{:>14}{:>14}{:>12}{:>8}\n", "parameter", "prior", "value", "std", "data");
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    fmt::format_to(out, "{:<24}{:>14.6g}{:>14.6g}{:>12.2e}{:>7.0f}%{}\n", parameter_name(parameters[i]), prior(k), p(k),
                   std(k), 100 * data_share(k), fitted[i] ? "" : "  not fitted");
  }
  return text;
}

}  // namespace deltadyn
