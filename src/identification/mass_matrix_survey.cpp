#include "deltadyn/identification/mass_matrix_survey.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

#include "deltadyn/runtime/dense.hpp"
#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/workspace.hpp"

namespace deltadyn {

MassMatrixSurvey survey_mass_matrix(const Robot& robot, const Eigen::VectorXd& p, int states, std::uint64_t seed,
                                    int keep) {
  if (states < 1 || keep < 1) {
    throw Error(fmt::format("a survey over {} states of which {} are kept", states, keep), "mass matrix",
                "give counts of at least 1", ExitCode::usage);
  }
  if (p.size() != robot.parameters()) {
    throw Error(fmt::format("{} values for {} parameters", p.size(), robot.parameters()), "mass matrix",
                "give one value for each parameter of the robot", ExitCode::usage);
  }
  const int n = robot.drives();
  const int kept = std::min(states, keep);
  MassMatrixSurvey survey;
  survey.states = states;
  survey.min_eigenvalue = std::numeric_limits<double>::infinity();
  survey.max_eigenvalue = -std::numeric_limits<double>::infinity();
  survey.task.resize(kept, n);
  survey.eigenvalues.resize(kept, n);

  WorkspaceSampler sampler(robot, seed);
  Eigen::VectorXd q(n), z(n);
  Eigen::MatrixXd M(n, n);
  for (int k = 0; k < states; ++k) {
    sampler.next(q);
    if (robot.forward_kinematics(q, z) != Status::ok || robot.mass_matrix(q, p, M) != Status::ok || !M.allFinite()) {
      throw Error("the mass matrix cannot be computed at a regular pose", robot.description().name,
                  "check the lengths in the robot file and the parameters");
    }
    const Eigen::VectorXd values = dense::eigenvalues(M);
    // Cholesky decides: an eigenvalue that rounding lifts above zero does not make M usable.
    const bool positive = dense::cholesky(M).positive_definite && values(0) > 0;
    if (!positive) ++survey.not_positive;
    survey.worst_condition = std::max(survey.worst_condition,
                                      positive ? values(n - 1) / values(0) : std::numeric_limits<double>::infinity());
    survey.max_eigenvalue = std::max(survey.max_eigenvalue, values(n - 1));
    if (values(0) < survey.min_eigenvalue) {
      survey.min_eigenvalue = values(0);
      survey.q_min = q;
      survey.z_min = z;
    }
    if (k < kept) {
      survey.task.row(k) = z;
      survey.eigenvalues.row(k) = values;
    }
  }
  return survey;
}

}  // namespace deltadyn
