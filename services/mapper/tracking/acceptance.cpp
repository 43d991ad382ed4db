#include "services/mapper/tracking/acceptance.hpp"

#include <cmath>

namespace curbstone::mapper::tracking {
namespace {

constexpr double kFirmOverlap = 0.4;
constexpr double kFoundOverlap = 0.3;
constexpr double kFirmInliers = 0.75;

}  // namespace

std::string why_refused(const Fit& fit, const config::TrackerConfig& config, const registration::Matrix6& drift,
                        Certainty guess) {
  const registration::RegistrationResult& result = fit.result;
  if (!result.converged) return "refused.not_converged";
  if (result.overlap < config.min_overlap) return "refused.overlap";
  if (result.inlier_ratio < config.min_inliers) return "refused.inliers";
  if (result.residual > config.max_residual) return "refused.residual";
  if (guess != Certainty::kFollowed) {  // ground alone fits everywhere
    if (result.overlap < (guess == Certainty::kFound ? kFoundOverlap : kFirmOverlap)) return "refused.overlap";
    if (result.inlier_ratio < kFirmInliers || (result.degenerate & registration::kPlanarAxes) != 0)
      return "refused.inliers";
  }
  const Pose jump = fit.prior.T_map_base.inverse() * result.T_map_base;
  const registration::Matrix6 covariance = drift + fit.prediction.covariance;
  const bool guided = fit.prediction.with_odometry;
  const double max_m = (guided ? config.max_jump_m : 0) + 3 * std::sqrt(covariance(0, 0));
  const double max_rad = (guided ? config.max_jump_rad : 0) + 3 * std::sqrt(covariance(3, 3));
  if (jump.translation().norm() > max_m || angle_of(jump) > max_rad) return "refused.jump";
  return {};
}

}  // namespace curbstone::mapper::tracking
