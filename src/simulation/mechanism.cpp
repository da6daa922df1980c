#include "deltadyn/simulation/mechanism.hpp"

#include <fmt/format.h>
#include <numeric>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/geometry_of.hpp"

namespace deltadyn {

namespace detail {

/// In mechanism_of.hpp, compiled for each type in src/robots.
template <class R>
std::unique_ptr<Mechanism> make_mechanism_of(const RobotDescription& description, const Eigen::VectorXd& p,
                                             const MechanismOptions& options);

}  // namespace detail

ParameterOptions mechanism_options(const RobotDescription& description) {
  ParameterOptions all;
  all.individual_limbs = all.offset = true;
  all.rotor_inertia.resize(static_cast<std::size_t>(description.drives()));
  std::iota(all.rotor_inertia.begin(), all.rotor_inertia.end(), 1);
  return all;
}

std::unique_ptr<Mechanism> make_mechanism(const RobotDescription& description, const Eigen::VectorXd& p,
                                          const MechanismOptions& options) {
  description.validate(description.name);
  if (const int count = make_robot(description, mechanism_options(description))->parameters(); p.size() != count) {
    throw Error(fmt::format("a mechanism has {} parameters, but {} are given", count, p.size()), description.name,
                "give one for each of a robot with mechanism_options()", ExitCode::usage);
  }
  return with_robot_type(description,
                         [&](auto type) { return detail::make_mechanism_of<decltype(type)>(description, p, options); });
}

}  // namespace deltadyn
