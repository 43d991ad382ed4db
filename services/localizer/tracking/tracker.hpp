#pragma once

#include <optional>
#include <vector>

#include "services/localizer/tracking/nearby_alternatives.hpp"
#include "services/localizer/tracking/odometry_scale.hpp"
#include "services/localizer/tracking/pose_tracker.hpp"

namespace curbstone::localizer::tracking {

/// Tracks one pose through the saved map. The vehicle is lost until the map has fitted for kConfirmations revolutions
/// in a row, and again when it has not fitted for as many. A lost pose continues with odometry and is reported as lost.
/// The vehicle is also lost when a nearby place fits clearly better; the tracker then continues from that place. A
/// vehicle that was found before is found again after kReconfirmations revolutions that fit. Pure; one thread.
class Tracker final : public PoseTracker {
 public:
  static constexpr int kConfirmations = 10;    ///< consecutive revolutions that fit, or do not
  static constexpr int kReconfirmations = 40;  ///< consecutive revolutions that fit, after it was lost on the way

  Tracker(const PoseBelief& start, const TrackingConfig& config) : config_(config), belief_(start) {}

  PoseFit track(const ThinnedScan& scan, const Motion& motion, fields::SavedMap& map) override;

  [[nodiscard]] const PoseBelief& belief() const override { return belief_; }
  [[nodiscard]] Matrix6 published_covariance() const override;
  [[nodiscard]] bool lost() const override { return lost_; }

 private:
  /// The share of the revolution, 0..1, that is independent of earlier ones. From nearly the same place the map's
  /// errors look the same, so the covariance of a standing vehicle must not shrink further.
  [[nodiscard]] double independent_share(const Motion& motion) const;
  void judge(const PoseFit& fit);
  /// The fit at a place nearby, if it is clearly better than `own`.
  [[nodiscard]] std::optional<PoseFit> better_nearby(const PoseFit& own, const ThinnedScan& scan,
                                                     fields::SavedMap& map);
  void continue_from(const PoseFit& elsewhere);

  TrackingConfig config_;
  PoseBelief belief_;
  OdometryScale scale_;
  Matrix6 information_ = Matrix6::Zero();  // of the last revolution that corrected the pose
  NearbyAlternatives alternatives_;
  int corrections_ = 0;  // consecutive revolutions that corrected the pose
  int revolution_ = 0;   // counts revolutions between two checks of the surroundings
  bool lost_ = true;
  bool was_found_ = false;
  int fitting_ = 0;  // consecutive revolutions
  int failing_ = 0;
};

}  // namespace curbstone::localizer::tracking
