#include "tools/bench/mapping/loop_run.hpp"

#include <cmath>

#include "tools/bench/mapping/gauges.hpp"

namespace curbstone::bench::mapping {
namespace {

/// Tracks the error of one estimate along the drive.
class ErrorTracker {
 public:
  explicit ErrorTracker(const drives::LoopDrive& drive) : drive_(drive) {}

  void on(std::int64_t utime, const Pose& T_any_base) {
    const Pose truth = drive_.T_world_base(utime);
    if (!started_) {
      started_ = true;
      T_world_any_ = truth * T_any_base.inverse();
      begin_ = drive_.way(utime);
    }
    const Eigen::Vector3d error = T_world_any_ * T_any_base.translation() - truth.translation();
    now_ = {drive_.way(utime) - begin_, error.norm(), std::abs(error.z())};
    if (drive_.way(utime) < drive_.returns()) before_ = now_;
  }
  [[nodiscard]] const LoopError& now() const { return now_; }
  [[nodiscard]] const LoopError& before() const { return before_; }

 private:
  const drives::LoopDrive& drive_;
  bool started_ = false;
  Pose T_world_any_ = Pose::Identity();
  double begin_ = 0;  // m
  LoopError now_, before_;
};

}  // namespace

LoopResult run_loop(const drives::LoopDrive& drive, const std::string& method, const std::vector<std::string>& settings,
                    const std::function<void(const LapFigures&)>& lap_done) {
  LoopResult result;
  ErrorTracker mapped(drive), odometry(drive);
  double lap_cpu = 0;  // ms
  int revolutions = 0;
  result.run = run_mapping(drive, method, settings, [&](const MappingMoment& moment) {
    if (moment.pose) mapped.on(moment.pose->utime, moment.pose->pose);
    if (moment.odometry) odometry.on(moment.odometry->utime, moment.odometry->pose);
    result.mapping_cpu_s += 1e-3 * moment.cpu_ms;
    lap_cpu += moment.cpu_ms;
    ++revolutions;
    if (!moment.pose || drive.way(moment.pose->utime) < drive.lap() * static_cast<double>(result.laps.size() + 1))
      return;
    result.laps.push_back({static_cast<int>(result.laps.size()) + 1, mapped.now(), moment.held_mb, resident_mb(),
                           lap_cpu / std::max(1, revolutions)});
    if (lap_done) lap_done(result.laps.back());
    lap_cpu = 0;
    revolutions = 0;
  });
  result.before = mapped.before();
  result.end = mapped.now();
  result.odometry_before = odometry.before();
  result.odometry_end = odometry.now();
  return result;
}

}  // namespace curbstone::bench::mapping
