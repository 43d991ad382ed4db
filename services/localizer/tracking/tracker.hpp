#pragma once

#include <vector>

#include "services/localizer/tracking/pose_tracker.hpp"
#include "services/localizer/tracking/surroundings.hpp"

namespace curbstone::localizer::tracking {

/// Follows one pose through the saved map. Until the map has fitted for half a second, and again when it has not for as
/// long, the vehicle is lost: the pose goes on with odometry and says so. It is lost too when a place near by fits
/// clearly better; that one is followed from then on, and must fit as long. Pure; one thread.
class Tracker final : public PoseTracker {
 public:
  static constexpr int kInARow = 10;       ///< revolutions that fit, or do not
  static constexpr int kInARowAgain = 40;  ///< that fit after it was lost on the way

  Tracker(const PoseBelief& start, const TrackingConfig& config) : config_(config), belief_(start) {}

  PoseFit track(const std::vector<Eigen::Vector3d>& points, const Motion& motion, fields::SavedMap& map) override;

  [[nodiscard]] const PoseBelief& belief() const override { return belief_; }
  [[nodiscard]] Matrix6 published_covariance() const override;
  [[nodiscard]] bool lost() const override { return lost_; }

 private:
  /// Share of the revolution, 0..1, that earlier ones did not say: from nearly the same place the map's errors look the
  /// same, so a vehicle that stands does not become surer and surer.
  [[nodiscard]] double news_of(const Motion& motion) const;
  void judge(const PoseFit& fit);
  void look_around(const std::vector<Eigen::Vector3d>& points, PoseFit& fit, fields::SavedMap& map);

  TrackingConfig config_;
  PoseBelief belief_;
  Matrix6 information_ = Matrix6::Zero();  // of the last revolution that corrected the pose
  Surroundings surroundings_;
  int looks_ = 0;       // revolutions in a row that corrected the pose
  int revolution_ = 0;  // of those between two looks around
  bool lost_ = true;
  bool was_found_ = false;
  int fitting_ = 0;  // revolutions in a row
  int failing_ = 0;
};

}  // namespace curbstone::localizer::tracking
