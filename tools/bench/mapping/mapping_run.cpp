#include "tools/bench/mapping/mapping_run.hpp"

#include <algorithm>

#include "common/statistics/quantile.hpp"
#include "tools/bench/mapping/gauges.hpp"
#include "tools/bench/mapping/methods/make_mapping_method.hpp"

namespace curbstone::bench::mapping {
namespace {

constexpr std::int64_t kIncrement = 500'000;  // us; `map.baseline` of the ekf

}  // namespace

MappingResult run_mapping(const drives::MappingDrive& drive, const std::string& method,
                          const std::vector<std::string>& settings,
                          const std::function<void(const MappingMoment&)>& watch) {
  MappingResult result;
  result.name = drive.name;
  result.method = method;
  result.prior = drive.prior;
  evaluate::truth::Trajectory track;
  IncrementConsistency consistency(drive.truth(), kIncrement);
  std::vector<double> wall, cpu;
  // Reserved beforehand, so that it does not count as the mapper's memory.
  track.reserve(drive.truth().size());
  wall.reserve(drive.truth().size());
  cpu.reserve(drive.truth().size());
  std::unique_ptr<methods::MappingMethod> mapper;
  double heap_without = 0;  // MB
  drive.play([&](const mapper::scan::Scan& scan, const mapper::scan::OdometryHistory& odometry) {
    if (!mapper) {
      heap_without = heap_mb();
      mapper = methods::make_mapping_method(method, drive, settings);
    }
    ++result.revolutions;
    const double wall_before = now_ms(CLOCK_MONOTONIC);
    const double cpu_before = now_ms(CLOCK_PROCESS_CPUTIME_ID);
    const auto pose = mapper->process(scan, odometry);
    wall.push_back(now_ms(CLOCK_MONOTONIC) - wall_before);
    cpu.push_back(now_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu_before);
    // The drive's own memory stays about as before the first revolution: it keeps no more than a few seconds.
    const double held = heap_mb() - heap_without;
    result.memory_mb = std::max(result.memory_mb, held);
    if (pose) track.push_back(*pose);
    if (const auto claimed = mapper->covariance(); pose && claimed) consistency.add(*pose, *claimed);
    if (!watch) return;
    MappingMoment moment{pose, std::nullopt, held, cpu.back(), &scan};
    if (odometry.covers(scan.end, scan.end))
      moment.odometry = evaluate::truth::StampedPose{scan.end, odometry.at(scan.end)};
    watch(moment);
  });
  if (mapper) {
    mapper->finish();
    result.content = mapper->content();
    result.rearranged = mapper->rearranged();
    result.corrected_m =
        evaluate::truth::trajectory_errors(evaluate::truth::pair_up(drive.truth(), mapper->trajectory())).ate_m;
  }
  result.poses = static_cast<int>(track.size());
  // The truth is compared at its own stamps; the estimate is interpolated between the ends of two revolutions.
  const evaluate::truth::PosePairs swapped = evaluate::truth::pair_up(track, drive.truth());
  result.track = {swapped.estimate, swapped.truth};
  result.nees = consistency.mean();
  result.errors = evaluate::truth::trajectory_errors(result.track);
  result.ms_median = quantile_or(wall, 0.5, 0);
  result.ms_p95 = quantile_or(wall, 0.95, 0);
  result.ms_max = quantile_or(wall, 1.0, 0);
  result.cpu_ms_median = quantile_or(cpu, 0.5, 0);
  result.cpu_ms_p95 = quantile_or(cpu, 0.95, 0);
  return result;
}

}  // namespace curbstone::bench::mapping
