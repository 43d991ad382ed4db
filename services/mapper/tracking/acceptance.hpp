#pragma once

#include <string>

#include "services/mapper/config/tracker_config.hpp"
#include "services/mapper/tracking/scan_matcher.hpp"

namespace curbstone::mapper::tracking {

/// Why a registration is not believed, as the name of the counter (refused.not_converged, .overlap, .inliers,
/// .residual, .jump); empty if it is. `drift`: covariance of the pose that it began from, in base_link axes. `firmly`:
/// more must fit, where the guess is not sure to be near.
[[nodiscard]] std::string why_refused(const Fit& fit, const config::TrackerConfig& config,
                                      const registration::Matrix6& drift, bool firmly);

}  // namespace curbstone::mapper::tracking
