#pragma once

#include <string>

#include "services/mapper/config/tracker_config.hpp"
#include "services/mapper/tracking/scan_matcher.hpp"

namespace curbstone::mapper::tracking {

/// How sure it is that a registration began near the truth. The less, the more must fit.
enum class Certainty {
  kFollowed,  ///< the scan before was believed, or nearly
  kFound,     ///< the vehicle was found again, perhaps beyond the map's end
  kGuessed,   ///< lost, or seconds were missed
};

/// Why a registration is not believed, as the name of the counter (refused.not_converged, .overlap, .inliers,
/// .residual, .jump); empty if it is. `drift`: covariance of the pose that it began from, in base_link axes.
[[nodiscard]] std::string why_refused(const Fit& fit, const config::TrackerConfig& config,
                                      const registration::Matrix6& drift, Certainty guess);

}  // namespace curbstone::mapper::tracking
