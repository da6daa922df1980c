#include "deltadyn/runtime/parameter_id.hpp"

#include <charconv>
#include <iterator>

namespace deltadyn {
namespace {

constexpr const char* kQuantities[] = {"", "viscous", "coulomb", "rotor_inertia", "offset"};  // of ParameterKind

}  // namespace

bool ParameterId::same_owner(const ParameterId& other) const {
  const bool inertial = kind == ParameterKind::inertial;
  return inertial == (other.kind == ParameterKind::inertial) && number == other.number && inner == other.inner &&
         (!inertial || body == other.body);
}

std::string owner_name(const ParameterId& id) {
  const char* joint = id.number > 0 ? "drive" : (id.inner == InnerJointKind::telescope ? "telescope" : "plate");
  return (id.kind == ParameterKind::inertial ? name(id.body) : joint) +
         (id.number > 0 ? std::to_string(id.number) : "");
}

std::string quantity_name(const ParameterId& id) {
  return id.kind == ParameterKind::inertial ? kInertialNames[id.entry] : kQuantities[static_cast<int>(id.kind)];
}

std::string parameter_name(const ParameterId& id) {
  return owner_name(id) + "." + quantity_name(id);
}

std::string parameter_unit(const ParameterId& id, bool turns) {
  switch (id.kind) {
    case ParameterKind::inertial: return kInertialUnits[id.entry];
    case ParameterKind::viscous: return turns ? "N*m*s/rad" : "N*s/m";
    case ParameterKind::rotor_inertia: return turns ? "kg*m^2" : "kg";
    default: return turns ? "N*m" : "N";
  }
}

std::optional<ParameterId> parameter_id(const std::string& name) {
  const std::string owner = name.substr(0, name.find('.'));
  const char* end = owner.data() + owner.size();
  ParameterId id;
  std::from_chars(owner.data() + owner.find_last_not_of("0123456789") + 1, end, id.number);
  for (int kind = 1; kind < static_cast<int>(std::size(kQuantities)); ++kind) {
    id.kind = static_cast<ParameterKind>(kind);
    for (const InnerJointKind inner : {InnerJointKind::telescope, InnerJointKind::plate}) {
      id.inner = inner;
      if (parameter_name(id) == name) return id;
    }
  }
  id.kind = ParameterKind::inertial;
  id.inner = InnerJointKind::telescope;
  for (std::size_t body = 0; body < std::size(kBodyNames); ++body) {
    id.body = static_cast<Body>(body);
    for (id.entry = 0; id.entry < kInertialParameters; ++id.entry)
      if (parameter_name(id) == name) return id;
  }
  return std::nullopt;
}

}  // namespace deltadyn
