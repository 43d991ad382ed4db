#include "services/mapper/unsteadiness.hpp"

#include <algorithm>

namespace curbstone {

Matrix6 Unsteadiness::first() {
  Vector6 sigma;
  sigma << Eigen::Vector3d::Constant(kFirstShift), Eigen::Vector3d::Constant(kFirstTurn);
  return sigma.cwiseAbs2().asDiagonal();
}

void Unsteadiness::add(const Twist& before, const Twist& now, double stride) {
  Vector6 change;
  change << now.linear - before.linear, now.angular - before.angular;
  change *= stride;
  seen_ = std::min(seen_ + 1, kMemory);
  mean_ += (change * change.transpose() - mean_) / seen_;
}

}  // namespace curbstone
