#include "deltadyn/simulation/mechanism.hpp"

#include <fmt/format.h>
#include <numeric>

#include "deltadyn/runtime/error.hpp"

#include "mechanism_of.hpp"

namespace deltadyn {

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
  const bool prismatic = description.drive_kind == DriveKind::prismatic;
  if (description.type == Delta3::kName) return detail::make_mechanism_of<Delta3>(description, p, options);
  if (description.type == LinearDelta3::kName) return detail::make_mechanism_of<LinearDelta3>(description, p, options);
  if (description.type == Delta4::kName) return detail::make_mechanism_of<Delta4>(description, p, options);
  if (description.type == Axis::kName) {
    return prismatic ? detail::make_mechanism_of<LinearAxis>(description, p, options)
                     : detail::make_mechanism_of<Axis>(description, p, options);
  }
  throw Error("robots of type '" + description.type + "' cannot be simulated", description.name,
              "use one of delta3, linear-delta3, delta4, axis");
}

}  // namespace deltadyn
