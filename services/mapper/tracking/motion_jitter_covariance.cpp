#include "services/mapper/tracking/motion_jitter_covariance.hpp"

#include <algorithm>

namespace curbstone::mapper::tracking {

registration::Matrix6 MotionJitterCovariance::first() {
  registration::Vector6 sigma;
  sigma << Eigen::Vector3d::Constant(kFirstShift), Eigen::Vector3d::Constant(kFirstTurn);
  return sigma.cwiseAbs2().asDiagonal();
}

void MotionJitterCovariance::add(const scan::Twist& before, const scan::Twist& now, double stride) {
  registration::Vector6 change;
  change << now.linear - before.linear, now.angular - before.angular;
  change *= stride;
  seen_ = std::min(seen_ + 1, kMemory);
  mean_ += (change * change.transpose() - mean_) / seen_;
}

}  // namespace curbstone::mapper::tracking
