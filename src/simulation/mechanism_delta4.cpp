#include "mechanism_of.hpp"

namespace deltadyn::detail {
template std::unique_ptr<Mechanism> make_mechanism_of<Delta4>(const RobotDescription&, const Eigen::VectorXd&,
                                                              const MechanismOptions&);
}  // namespace deltadyn::detail
