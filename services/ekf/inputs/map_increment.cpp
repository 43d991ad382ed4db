#include "services/ekf/inputs/map_increment.hpp"

#include <string>

#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::inputs {

namespace {

constexpr double kMaxBaseline = 2.0;  // s: beyond it the errors are no longer those of the present
constexpr double kNoWeight = 1e6;     // m^2 or rad^2
constexpr double kMaxSigma = 1.0;     // m or rad: beyond it the mapper itself is uncertain

PoseCovariance in_map(const map_pose_t& message) {
  PoseCovariance out;
  for (int i = 0; i < 36; ++i) out(i / 6, i % 6) = static_cast<double>(message.covariance[i]);
  return out;
}

/// MAP_POSE's covariance in base_link's axes plus a floor: the mapper's covariance covers noise, not wrong planes.
PoseCovariance covariance_of(const map_pose_t& message, const Pose& T_map_base, const base::MapFusionConfig& config) {
  Eigen::Matrix<double, 6, 6> to_base = Eigen::Matrix<double, 6, 6>::Identity();
  to_base.topLeftCorner<3, 3>() = T_map_base.linear().transpose();
  PoseCovariance out = to_base * in_map(message) * to_base.transpose();
  out.diagonal().head<3>().array() += config.translation_noise * config.translation_noise;
  out.diagonal().tail<3>().array() += config.rotation_noise * config.rotation_noise;
  for (int axis = 0; axis < 6; ++axis)
    if ((message.degenerate >> axis & 1) != 0) out(axis, axis) += kNoWeight;
  return out;
}

/// nullptr if it can be used.
const char* why_refused(const map_pose_t& message, const Pose& T_map_base) {
  if ((message.flags & map_pose_t::LOST) != 0) return "lost";
  if ((message.flags & map_pose_t::REGISTERED) == 0) return "not_registered";
  const PoseCovariance covariance = in_map(message);
  if (!is_finite(T_map_base) || !covariance.allFinite() || covariance.diagonal().minCoeff() < 0.0) return "not_finite";
  if (covariance.diagonal().maxCoeff() > kMaxSigma * kMaxSigma) return "uncertain";
  return nullptr;
}

}  // namespace

std::optional<MapIncrement> MapIncrements::add(const map_pose_t& message) {
  const Pose T_map_base = pose_from_arrays(message.map_base_position, message.map_base_orientation);
  if (const char* cause = why_refused(message, T_map_base)) {
    counters_.add(std::string("refused.") + cause + ".map");
    last_.reset();
    return std::nullopt;
  }
  if (last_ && last_->epoch != message.epoch) counters_.add("map.epochs");
  const Last now{message.utime, message.epoch, T_map_base, covariance_of(message, T_map_base, config_)};
  const double elapsed = last_ ? base::seconds_between(last_->utime, now.utime) : 0.0;
  const bool follows = last_ && last_->epoch == now.epoch && elapsed > 0.0 && elapsed <= kMaxBaseline;
  if (!follows) {
    last_ = now;
    return std::nullopt;
  }
  if (elapsed < config_.baseline) return std::nullopt;
  MapIncrement out{last_->utime, now.utime, last_->T_map_base.inverse() * now.T_map_base, {}};
  out.covariance = covariance_of_increment(out.T_begin_end, last_->covariance, now.covariance);
  last_ = now;
  return out;
}

}  // namespace curbstone::ekf::inputs
