#include "deltadyn/excitation/criterion.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"

namespace deltadyn {
namespace {

constexpr std::pair<const char*, Criterion> kWords[] = {{"logdet", Criterion::log_det},
                                                        {"det", Criterion::det},
                                                        {"cond", Criterion::cond},
                                                        {"trace", Criterion::trace},
                                                        {"min-eigenvalue", Criterion::min_eigenvalue}};

CriterionValue of_determinant(Criterion criterion, const Eigen::MatrixXd& M) {
  const dense::Cholesky factor = dense::cholesky(M);
  if (!factor.positive_definite) return {};
  const auto p = static_cast<double>(M.rows());
  CriterionValue result;
  result.regular = true;
  result.value = 2 * factor.L.diagonal().array().log().sum();
  result.by_M = dense::solve(factor, Eigen::MatrixXd::Identity(M.rows(), M.cols()));
  if (criterion == Criterion::det) {
    result.value = std::exp(result.value / p);
    result.by_M *= result.value / p;
  } else if (criterion == Criterion::trace) {
    const double trace = result.by_M.trace();
    result.value = -std::log(trace);
    result.by_M = (result.by_M * result.by_M / trace).eval();
  }
  return result;
}

}  // namespace

Criterion criterion_of(const std::string& word) {
  for (const auto& [name, criterion] : kWords)
    if (word == name) return criterion;
  throw Error("'" + word + "' is not a criterion", "", "use logdet, det, cond, trace or min-eigenvalue",
              ExitCode::usage);
}

const char* word_of(Criterion criterion) {
  for (const auto& [name, value] : kWords)
    if (value == criterion) return name;
  return "";
}

CriterionValue evaluate(Criterion criterion, const Eigen::MatrixXd& M) {
  if (!M.allFinite()) return {};
  if (criterion != Criterion::cond && criterion != Criterion::min_eigenvalue) return of_determinant(criterion, M);
  const dense::Spectrum spectrum = dense::spectrum(M);
  const Eigen::VectorXd& values = spectrum.values;
  const Eigen::Index last = values.size() - 1;
  if (!(values(0) > 1e-14 * values(last))) return {};
  const auto by = [&](Eigen::Index k) -> Eigen::MatrixXd {
    return spectrum.vectors.col(k) * spectrum.vectors.col(k).transpose() / values(k);
  };
  CriterionValue result;
  result.regular = true;
  result.value = std::log(values(0));
  result.by_M = by(0);
  if (criterion == Criterion::cond) {
    result.value -= std::log(values(last));
    result.by_M -= by(last);
  }
  return result;
}

double log_determinant(const Eigen::MatrixXd& M) {
  const auto [L, positive_definite] = dense::cholesky(M);
  if (!positive_definite) return -std::numeric_limits<double>::infinity();
  return 2 * L.diagonal().array().log().sum();
}

}  // namespace deltadyn
