#include "services/ekf/filter/lost_heading.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::ekf::filter {

namespace {

constexpr double kMaxVariance = 1.0;  // rad^2: beyond it the direction is arbitrary

Eigen::Vector3d up_of(const model::Belief& belief) {
  return belief.mean.attitude.conjugate() * Eigen::Vector3d::UnitZ();
}

double heading_variance(const model::Belief& belief) {
  const Eigen::Vector3d up = up_of(belief);
  return up.dot(belief.covariance.block<3, 3>(model::kAttitude, model::kAttitude) * up);
}

}  // namespace

/// Keeps the large heading error about the vertical when a correction of the tilt turns the body axes.
void LostHeading::correct(model::Belief& belief, const model::Observation& z, const model::Gain& gain) const {
  if (!lost_) return model::correct(belief, z, gain);
  const Eigen::Quaterniond before = belief.mean.attitude;
  const double variance = heading_variance(belief);
  model::correct(belief, z, gain);
  model::ErrorMatrix turn = model::ErrorMatrix::Identity();
  turn.block<3, 3>(model::kAttitude, model::kAttitude) = (belief.mean.attitude.conjugate() * before).toRotationMatrix();
  belief.covariance = model::propagated(turn, belief.covariance);
  const Eigen::Vector3d up = up_of(belief);
  belief.covariance.block<3, 3>(model::kAttitude, model::kAttitude) +=
      std::max(variance - heading_variance(belief), 0.0) * up * up.transpose();
}

void LostHeading::propagate(model::Belief& belief, double distance) {
  if (!lost_) return;
  const double before = position_sigma_;
  position_sigma_ += 0.5 * std::min(heading_variance(belief), kMaxVariance) * std::abs(distance);
  belief.covariance.diagonal().segment<2>(model::kPosition).array() +=
      position_sigma_ * position_sigma_ - before * before;
}

}  // namespace curbstone::ekf::filter
