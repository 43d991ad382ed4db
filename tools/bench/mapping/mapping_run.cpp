#include "tools/bench/mapping/mapping_run.hpp"

#include <algorithm>

#include "common/statistics/quantile.hpp"
#include "tools/bench/mapping/gauges.hpp"
#include "tools/bench/mapping/methods/make_mapping_method.hpp"

namespace curbstone::bench::mapping {
namespace {

constexpr std::int64_t kIncrement = 500'000;  // us; `map.baseline` of the ekf

/// What is measured of each revolution. Reserved beforehand, so that it does not count as the mapper's memory.
struct Measured {
  evaluate::truth::Trajectory track;
  std::vector<double> wall_ms, cpu_ms;

  explicit Measured(std::size_t revolutions) {
    track.reserve(revolutions);
    wall_ms.reserve(revolutions);
    cpu_ms.reserve(revolutions);
  }
};

std::optional<evaluate::truth::StampedPose> process_timed(methods::MappingMethod& mapper,
                                                          const mapper::scan::Scan& scan,
                                                          const mapper::scan::OdometryHistory& odometry,
                                                          Measured& measured) {
  const double wall_before = now_ms(CLOCK_MONOTONIC);
  const double cpu_before = now_ms(CLOCK_PROCESS_CPUTIME_ID);
  auto pose = mapper.process(scan, odometry);
  measured.wall_ms.push_back(now_ms(CLOCK_MONOTONIC) - wall_before);
  measured.cpu_ms.push_back(now_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu_before);
  return pose;
}

MappingMoment moment_of(const std::optional<evaluate::truth::StampedPose>& pose, double held, double cpu_ms,
                        const mapper::scan::Scan& scan, const mapper::scan::OdometryHistory& odometry) {
  MappingMoment moment{pose, std::nullopt, held, cpu_ms, &scan};
  if (odometry.covers(scan.end, scan.end))
    moment.odometry = evaluate::truth::StampedPose{scan.end, odometry.at(scan.end)};
  return moment;
}

/// The figures of the poses and of the time they took.
MappingResult figures_of(const Measured& measured, const evaluate::truth::Trajectory& truth) {
  MappingResult result;
  result.poses = static_cast<int>(measured.track.size());
  // The truth is compared at its own stamps; the estimate is interpolated between the ends of two revolutions.
  const evaluate::truth::PosePairs swapped = evaluate::truth::pair_up(measured.track, truth);
  result.track = {swapped.estimate, swapped.truth};
  result.errors = evaluate::truth::trajectory_errors(result.track);
  result.ms_median = quantile_or(measured.wall_ms, 0.5, 0);
  result.ms_p95 = quantile_or(measured.wall_ms, 0.95, 0);
  result.ms_max = quantile_or(measured.wall_ms, 1.0, 0);
  result.cpu_ms_median = quantile_or(measured.cpu_ms, 0.5, 0);
  result.cpu_ms_p95 = quantile_or(measured.cpu_ms, 0.95, 0);
  return result;
}

}  // namespace

MappingResult run_mapping(const drives::MappingDrive& drive, const std::string& method,
                          const std::vector<std::string>& settings,
                          const std::function<void(const MappingMoment&)>& watch) {
  const evaluate::truth::Trajectory& truth = drive.truth();
  IncrementConsistency consistency(truth, kIncrement);
  Measured measured(truth.size());
  std::unique_ptr<methods::MappingMethod> mapper;
  double heap_without = 0, most_held = 0;  // MB
  drive.play([&](const mapper::scan::Scan& scan, const mapper::scan::OdometryHistory& odometry) {
    if (!mapper) {
      heap_without = heap_mb();
      mapper = methods::make_mapping_method(method, drive, settings);
    }
    const auto pose = process_timed(*mapper, scan, odometry, measured);
    // The drive's own memory stays about as before the first revolution: it keeps no more than a few seconds.
    const double held = heap_mb() - heap_without;
    most_held = std::max(most_held, held);
    if (pose) measured.track.push_back(*pose);
    if (const auto claimed = mapper->covariance(); pose && claimed) consistency.add(*pose, *claimed);
    if (watch) watch(moment_of(pose, held, measured.cpu_ms.back(), scan, odometry));
  });
  MappingResult result = figures_of(measured, truth);
  result.name = drive.name;
  result.method = method;
  result.prior = drive.prior;
  result.revolutions = static_cast<int>(measured.wall_ms.size());
  result.memory_mb = most_held;
  result.nees = consistency.mean();
  if (!mapper) return result;
  mapper->finish();
  result.content = mapper->content();
  result.rearranged = mapper->rearranged();
  result.corrected_m = evaluate::truth::trajectory_errors(evaluate::truth::pair_up(truth, mapper->trajectory())).ate_m;
  return result;
}

}  // namespace curbstone::bench::mapping
