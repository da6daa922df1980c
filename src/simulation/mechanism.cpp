#include "deltadyn/simulation/mechanism.hpp"

#include <numeric>

#include "deltadyn/runtime/error.hpp"
#include "deltadyn/runtime/robot.hpp"

#include "mechanism_of.hpp"

namespace deltadyn {

std::vector<std::string> mechanism_parameter_names(const RobotDescription& description) {
  ParameterOptions all;
  all.individual_limbs = all.offset = true;
  all.rotor_inertia.resize(static_cast<std::size_t>(description.drives()));
  std::iota(all.rotor_inertia.begin(), all.rotor_inertia.end(), 1);
  return make_robot(description, all)->parameter_names();
}

std::unique_ptr<Mechanism> make_mechanism(const RobotDescription& description, const Eigen::VectorXd& p,
                                          const MechanismOptions& options) {
  description.validate(description.name);
  if (p.size() != static_cast<Eigen::Index>(mechanism_parameter_names(description).size())) {
    throw Error("a mechanism has " + std::to_string(mechanism_parameter_names(description).size()) + " parameters, but " +
                    std::to_string(p.size()) + " are given",
                description.name, "give one for each of mechanism_parameter_names()", ExitCode::usage);
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
