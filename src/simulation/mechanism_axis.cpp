#include "mechanism_of.hpp"

namespace deltadyn::detail {
template std::unique_ptr<Mechanism> make_mechanism_of<Axis>(const RobotDescription&, const Eigen::VectorXd&,
                                                            const MechanismOptions&);
template std::unique_ptr<Mechanism> make_mechanism_of<LinearAxis>(const RobotDescription&, const Eigen::VectorXd&,
                                                                  const MechanismOptions&);
}  // namespace deltadyn::detail
