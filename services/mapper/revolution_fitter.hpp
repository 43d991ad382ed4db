#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "common/geometry.hpp"
#include "services/mapper/deskew.hpp"
#include "services/mapper/mapper_config.hpp"
#include "services/mapper/motion_expectation.hpp"
#include "services/mapper/motion_filter.hpp"
#include "services/mapper/registration.hpp"
#include "services/mapper/revolution.hpp"

namespace curbstone {

/// Where the vehicle was at the end of the last revolution.
struct Departure {
  std::int64_t end = 0;  ///< us
  Pose T_map_base = Pose::Identity();
  Matrix6 drift = Matrix6::Zero();  ///< covariance of it, in base_link axes, if it is only a guess
};

/// A revolution in the map.
struct Fit {
  MotionExpectation expected;
  PosePrior prior;                 ///< where it was sought
  RegistrationResult result;       ///< where it is
  std::vector<LidarPoint> points;  ///< de-skewed, in base_link
  MotionFilter motion;             ///< without odometry: what it has learnt of the motion
  /// 0..1: share of the revolution's points that lie on a surface of the map.
  [[nodiscard]] double agreement() const { return result.overlap * result.inlier_ratio; }
};

/// De-skews a revolution and registers it: with odometry one after the other; without, the motion within the revolution
/// is sought along with the pose. Keeps the map for registration. One thread.
class RevolutionFitter {
 public:
  explicit RevolutionFitter(const MapperConfig& config);

  [[nodiscard]] Registration& map() { return *registration_; }
  [[nodiscard]] const Registration& map() const { return *registration_; }
  void clear_map();

  /// The revolution as it is expected to lie, not registered.
  [[nodiscard]] Fit expect(const Departure& from, const Revolution& revolution, MotionExpectation expected) const;
  /// Registers it. `motion`: how the vehicle moved until now, as far as revolutions told.
  [[nodiscard]] Fit fit(const Departure& from, const Revolution& revolution, MotionExpectation expected,
                        const MotionFilter& motion);
  /// Where the expectation has failed and there is no odometry: begins from other motions too, and gives the answer
  /// that most points agree with.
  [[nodiscard]] Fit fit_from_afar(const Departure& from, const Revolution& revolution, const MotionFilter& motion);
  /// The first two revolutions of a drive, where nothing tells how fast it is: seeks at all speeds up to `max_speed`.
  /// The map for registration becomes the first, de-skewed, which ended at `from`; its points come out in
  /// `first_points`.
  [[nodiscard]] Fit fit_second(const Departure& from, const Revolution& first, const Revolution& second,
                               std::vector<LidarPoint>& first_points);

  /// De-skewed, in base_link, without what the vehicle sees of itself.
  [[nodiscard]] std::vector<LidarPoint> in_base(const Revolution& revolution, const SweepMotion& sweep) const;

 private:
  void refine_motion(const Departure& from, const Revolution& revolution, const MotionFilter& before, Fit& fit);

  MapperConfig config_;
  Pose T_base_lidar_;
  Eigen::AlignedBox3f own_body_;  ///< base_link
  std::unique_ptr<Registration> registration_;
};

}  // namespace curbstone
