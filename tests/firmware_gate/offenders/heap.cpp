// Does what the core must not do, to show that the symbol check sees it.

#include <Eigen/Core>
#include <stdexcept>

double offend(int size) {
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(size, 0.0, 1.0);
  if (values.sum() > 10.0) throw std::runtime_error("too much");
  return values.norm();
}
