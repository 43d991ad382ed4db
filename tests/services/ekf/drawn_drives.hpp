#pragma once

#include <random>
#include <vector>

#include "services/ekf/filter/filter.hpp"
#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone::ekf {

// 50 runs of n: chi-square with 50 n degrees of freedom, 99.9 % two-sided, over 50.
inline constexpr int kRuns = 50;
inline constexpr double kLow6 = 226.0 / kRuns, kHigh6 = 387.0 / kRuns;

/// A filter whose configuration is what drawn() draws from.
[[nodiscard]] base::EkfConfig true_config();
/// A drive whose errors are drawn from the distributions that the filter is configured with.
[[nodiscard]] DriveOptions drawn(const base::EkfConfig& config, unsigned seed);

/// A drive at 2 to 8 m/s in curves and on hills, with large biases, and radii and a track that are wrong.
[[nodiscard]] DriveOptions drawn_uncalibrated(std::mt19937& random);

/// Normalised error squared of a pose; odom began at `start`, an index into the truth.
[[nodiscard]] double pose_nees(const model::Estimate& e, const Drive& drive, std::size_t start);

/// Runs the filter over the drive; `look(k, filter, estimate, start)` at each of the times.
template <std::size_t N, class Look>
std::vector<model::Estimate> run_and_look(filter::Filter& filter, const Drive& drive, const double (&times)[N],
                                          Look look) {
  std::vector<model::Estimate> out;
  std::size_t start = 0;
  std::size_t k = 0;
  std::size_t w = 0;
  for (std::size_t i = 0; i < drive.imu.size(); ++i) {
    for (; w < drive.wheels.size() && drive.wheels[w].utime <= drive.imu[i].utime; ++w)
      filter.add(drive.wheels[w], out);
    const bool first = out.empty();
    filter.add(drive.imu[i], out);
    if (first) start = i;
    if (k == N || base::seconds_between(drive.imu.front().utime, drive.imu[i].utime) < times[k]) continue;
    look(k++, out.back(), start);
  }
  return out;
}

/// Runs the filter over the drive.
[[nodiscard]] std::vector<model::Estimate> run(filter::Filter& filter, const Drive& drive);
/// How far the last estimate is off, as a share of the way; odom began at the first one.
[[nodiscard]] double end_error(const std::vector<model::Estimate>& estimates, const Drive& drive);

}  // namespace curbstone::ekf
