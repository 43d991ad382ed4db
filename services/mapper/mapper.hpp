#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/counters.hpp"
#include "common/geometry.hpp"
#include "services/mapper/dense_map.hpp"
#include "services/mapper/deskew.hpp"
#include "services/mapper/mapper_config.hpp"
#include "services/mapper/odometry_history.hpp"
#include "services/mapper/registration.hpp"
#include "services/mapper/revolution.hpp"

namespace curbstone {

/// Where the vehicle was at the end of a revolution, and what the revolution did to the map.
struct MapperUpdate {
  std::int64_t utime = 0;  ///< us, end of the revolution
  std::int32_t revolution = 0;
  Pose T_map_base = Pose::Identity();
  Pose T_map_odom = Pose::Identity();  ///< the last known, where odometry is missing
  RegistrationResult registration;     ///< covariance still in base_link axes
  bool registered = false;
  bool with_odometry = false;
  bool stationary = false;
  std::vector<TileKey> grown;  ///< tiles with new points
};

/// The mapper's method: de-skew, register, insert. A function of the sequence of calls alone. Pure; one thread.
///
/// Counters: revolutions, keyframes, refused.sparse, refused.time, refused.not_converged, refused.overlap,
/// refused.inliers, refused.residual, refused.jump, odometry.not_believed, without_odometry.
class Mapper {
 public:
  explicit Mapper(const MapperConfig& config);

  /// Takes the next revolution; nothing when it cannot be placed in time (once more, late by less than a second, longer
  /// than one, ended before it began) or holds too few points that can be measurements. Such changes nothing.
  [[nodiscard]] std::optional<MapperUpdate> process(const Revolution& revolution, const OdometryHistory& odometry);

  /// The drive is over: what still waits goes into the dense map. Tiles with new points.
  [[nodiscard]] std::vector<TileKey> finish();

  [[nodiscard]] bool started() const { return last_.has_value(); }
  [[nodiscard]] const DenseMap& dense() const { return dense_; }
  [[nodiscard]] DenseMap& dense() { return dense_; }
  /// Voxels of the map that registration keeps; bounded by its window.
  [[nodiscard]] std::size_t registration_size() const { return registration_->size(); }
  [[nodiscard]] const Counters& counters() const { return counters_; }
  /// Revolutions in a row that could not be registered.
  [[nodiscard]] int refused_in_a_row() const { return refused_in_a_row_; }

 private:
  struct Last {
    std::int64_t end = 0;
    Pose T_map_base = Pose::Identity();
  };
  /// What is known of the motion before the LiDAR is looked at.
  struct Expectation {
    bool with_odometry = false;  // odometry spans from the last revolution's end to this one's
    bool stationary = false;
    SweepMotion sweep;
    Pose T_last_base = Pose::Identity();   // base now, seen from base at the last revolution's end
    Matrix6 covariance = Matrix6::Zero();  // of T_last_base
  };
  /// One registration of a revolution, beginning from an expectation.
  struct Attempt {
    Expectation expected;
    PosePrior prior;
    std::vector<LidarPoint> points;  // de-skewed, in base_link
    RegistrationResult result;
    std::string refusal;  // the counter of why it is not believed; empty if it is
    bool believed = false;
  };

  [[nodiscard]] Expectation expect(const Revolution& revolution, const OdometryHistory& odometry);
  [[nodiscard]] Expectation expect_steady(const Revolution& revolution) const;
  [[nodiscard]] std::vector<LidarPoint> in_base(const Revolution& revolution, const SweepMotion& sweep) const;
  [[nodiscard]] Attempt try_with(const Revolution& revolution, Expectation expected);
  void align(const Revolution& revolution, Attempt& attempt);
  [[nodiscard]] std::string refusal(const Attempt& attempt) const;
  void conclude(const Revolution& revolution, const OdometryHistory& odometry, const Attempt& attempt,
                MapperUpdate& update);
  void start(const Revolution& revolution, const OdometryHistory& odometry, MapperUpdate& update);
  void begin_registration_map(const Twist& twist);
  [[nodiscard]] bool finish_start(MapperUpdate& update);
  void insert(const std::vector<LidarPoint>& points, MapperUpdate& update);
  /// A revolution of the first standstill, kept out of the dense map for now.
  struct Held {
    std::vector<LidarPoint> points;
    Pose T_map_base;
    std::int64_t utime;
  };
  [[nodiscard]] bool holds_back(const std::vector<LidarPoint>& points, const MapperUpdate& update);
  [[nodiscard]] std::vector<TileKey> insert_held();

  MapperConfig config_;
  Pose T_base_lidar_;
  std::unique_ptr<Registration> registration_;
  DenseMap dense_;
  std::optional<Last> last_;
  std::optional<Revolution> first_;       // until its motion is known, where there is no odometry
  std::vector<LidarPoint> first_points_;  // of it, de-skewed
  Twist twist_;                           // over the last revolution
  double stride_ = 0.05;                  // s from revolution to revolution
  Pose T_map_odom_ = Pose::Identity();
  Pose T_map_keyframe_ = Pose::Identity();  // when the registration map last took a revolution
  Pose T_map_moved_ = Pose::Identity();     // when the vehicle was last known to move
  std::int64_t moved_ = 0;                  // us, when that was
  std::int64_t started_ = 0;                // us, the end of the first revolution
  bool has_moved_ = false;                  // since then
  std::vector<Held> held_;
  Matrix6 drift_ = Matrix6::Zero();  // covariance of the pose at the end of the last revolution, if that was refused
  int refused_in_a_row_ = 0;
  Counters counters_;
};

}  // namespace curbstone
