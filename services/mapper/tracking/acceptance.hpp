#pragma once

#include <string>

#include "services/mapper/config/tracker_config.hpp"
#include "services/mapper/tracking/scan_matcher.hpp"

namespace curbstone::mapper::tracking {

/// How certain it is that a registration began near the true pose. The less certain, the stricter the checks.
enum class Certainty {
  kFollowed,  ///< tracking: a scan was accepted a short time ago
  kFound,     ///< tentative: relocalised, perhaps beyond the end of the map
  kGuessed,   ///< lost, or seconds of messages were missed
};

/// Why a registration is refused, as the name of the counter (refused.not_converged, .overlap, .inliers, .residual,
/// .jump); empty if it is accepted. `drift`: covariance of the pose that it began from, in base_link axes.
[[nodiscard]] std::string why_refused(const Fit& fit, const config::TrackerConfig& config,
                                      const registration::Matrix6& drift, Certainty guess);

}  // namespace curbstone::mapper::tracking
