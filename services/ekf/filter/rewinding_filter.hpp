#pragma once

#include <deque>
#include <utility>
#include <vector>

#include "services/ekf/filter/filter.hpp"
#include "services/ekf/inputs/sequencer.hpp"

namespace curbstone::ekf::filter {

/// A Filter that applies late samples at their own time. It keeps the samples of the last `timing.history` seconds and
/// check points among them, goes back to the check point before a late sample and repeats everything from there, as
/// robot_localization (`smooth_lagged_data`) and pronto (`update_history`) do. From then on its belief is, bit for bit,
/// that of a filter that received all samples in order.
///
/// No estimate is published twice, and odom stays continuous: after a rewind the pose continues from where the last
/// estimate was. No measurement depends on position and heading, so they are changed on output only, by T_odom_filter,
/// a translation and a turn about the vertical. The covariance grows by their squares, because they are known errors
/// that are kept.
///
/// A sample is late if it is older than the newest by at most the history; if it is older still, the clock was set
/// back.
class RewindingFilter {
 public:
  using Sample = inputs::Sequencer::Sample;

  explicit RewindingFilter(const base::EkfConfig& config);

  /// See Filter::inherit().
  void inherit(const model::Belief& belief) { filter_.inherit(belief); }

  /// Appends to `out` the estimates that are newer than all before.
  void add(const Sample& sample, std::vector<model::Estimate>& out);

  [[nodiscard]] const Filter& filter() const { return filter_; }
  [[nodiscard]] Counters counters() const;

 private:
  /// Order of samples: by stamp; at equal stamps wheels, IMU, map (Sample's own order).
  using Key = std::pair<std::int64_t, std::size_t>;
  struct CheckPoint {
    Key after;  // key of the last sample that it includes
    Filter filter;
  };

  [[nodiscard]] static Key key_of(const Sample& sample);
  void clear_history();
  void drop_old_samples();
  void run(const Sample& sample);
  void rewind_to(const Key& late);
  void continue_from_last_published();
  void publish(std::vector<model::Estimate>& out);

  std::int64_t history_;  // us
  Filter filter_;
  std::deque<std::pair<Key, Sample>> samples_;  // by key, starting at the first check point
  std::deque<CheckPoint> check_points_;
  std::vector<model::Estimate> estimates_;  // of the filter, not yet processed
  PoseHistory published_;
  std::int64_t last_published_ = INT64_MIN;  // us
  Pose T_odom_filter_ = Pose::Identity();
  Eigen::Matrix3d position_shift_ = Eigen::Matrix3d::Zero();  // sum of squares, odom axes, m^2
  double heading_shift_ = 0.0;                                // sum of squares, rad^2
  Counters counters_;
};

}  // namespace curbstone::ekf::filter
