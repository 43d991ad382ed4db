// Development tool, no test: drives the mapper over a KITTI folder and prints errors and times.
//   bench_mapper FOLDER [prior] [KEY=VALUE...]   prior: 2 % wheel scale and 0.2 deg/s gyro bias, made of the reference
#include <fmt/format.h>

#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "services/mapper/mapper.hpp"
#include "services/mapper/revolution_assembler.hpp"
#include "tests/services/mapper/kitti_drive.hpp"

namespace {

using namespace curbstone;

/// ms of CPU of this thread: the machine is shared.
double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

/// Odometry at 100 Hz that drifts from the reference as poor sensors would: differentiates and integrates again.
std::vector<OdometrySample> poor_odometry(const test::KittiDrive& drive) {
  std::vector<OdometrySample> out;
  Pose T = Pose::Identity();
  Pose before = drive.reference[0];
  const auto pose_at = [&](std::int64_t t) {
    const auto after = std::upper_bound(drive.stamps.begin(), drive.stamps.end(), t);
    const auto j = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(after - drive.stamps.begin(), 1, static_cast<std::ptrdiff_t>(drive.size()) - 1));
    const double f =
        static_cast<double>(t - drive.stamps[j - 1]) / static_cast<double>(drive.stamps[j] - drive.stamps[j - 1]);
    return move(twist_of(drive.reference[j - 1].inverse() * drive.reference[j], 1.0), f);
  };
  const auto absolute = [&](std::int64_t t) {
    const auto after = std::upper_bound(drive.stamps.begin(), drive.stamps.end(), t);
    const auto j = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(after - drive.stamps.begin(), 1, static_cast<std::ptrdiff_t>(drive.size()) - 1));
    return drive.reference[j - 1] * pose_at(t);
  };
  const std::int64_t begin = drive.stamps.front() - drive.period;
  before = absolute(begin);
  for (std::int64_t t = begin; t < drive.stamps.back() + drive.period; t += 10'000) {
    const Pose now = absolute(t);
    Twist twist = twist_of(before.inverse() * now, 1.0);
    twist.linear *= 1.02;
    twist.angular.z() += 0.2 * 3.14159265 / 180 * 0.01;
    T = normalised(T * move(twist, 1.0));
    before = now;
    out.push_back({t, T, true, false});
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const test::KittiDrive drive = test::load_kitti(argv[1]);
  ConfigOf<MapperConfig> config;
  config.value.vehicle.lidar = {0, 0, 0, 0, 0, 0};
  config.value.dense.min_height = -4.7;
  bool with_prior = false;
  for (int i = 2; i < argc; ++i) {
    if (std::strcmp(argv[i], "prior") == 0)
      with_prior = true;
    else
      set_config_value(argv[i], config);
  }
  RevolutionAssembler assembler;
  OdometryHistory odometry;
  if (with_prior) {
    for (const OdometrySample& sample : poor_odometry(drive)) odometry.add(sample);
  }
  Mapper mapper(config.value);
  std::vector<Pose> ends;
  std::vector<std::int64_t> times;
  std::vector<double> ms;
  double residual = 0, inliers = 0, iterations = 0, used = 0;
  int degenerate = 0;
  const auto take = [&](const std::optional<Revolution>& revolution) {
    if (!revolution) return;
    const double begin = cpu_ms();
    const auto update = mapper.process(*revolution, odometry);
    ms.push_back(cpu_ms() - begin);
    if (!update) return;
    ends.push_back(update->T_map_base);
    times.push_back(update->utime);
    residual += update->registration.residual;
    inliers += update->registration.inlier_ratio;
    iterations += update->registration.iterations;
    used += update->registration.overlap;
    degenerate |= update->registration.degenerate;
  };
  for (std::size_t scan = 0; scan < drive.size(); ++scan) {
    for (const lidar_points_t& packet : drive.packets(scan)) take(assembler.add(packet));
  }
  take(assembler.flush());

  // The reference speaks of the stamps, mid-sweep: interpolate between the ends of two sweeps.
  std::vector<Pose> estimate;
  std::vector<Pose> reference;
  for (std::size_t i = 1; i < ends.size() && i < drive.size(); ++i) {
    const double f = static_cast<double>(drive.stamps[i] - times[i - 1]) / static_cast<double>(times[i] - times[i - 1]);
    estimate.push_back(ends[i - 1] * move(twist_of(ends[i - 1].inverse() * ends[i], 1.0), f));
    reference.push_back(drive.reference[i]);
  }
  const test::TrajectoryError e = test::compare(estimate, reference);
  std::sort(ms.begin(), ms.end());
  const double n = static_cast<double>(ends.size());
  fmt::print(
      "t_rel {:.3f} %  r_rel {:.4f} deg/m  ATE {:.3f} m  end {:.2f} %  of {:.1f} m | ms median {:.1f} p95 {:.1f} | "
      "residual {:.3f} "
      "inliers {:.2f} iterations {:.1f} overlap {:.2f} degenerate {:x} points {}\n",
      e.t_rel_percent, e.r_rel_deg_per_m, e.ate_m, e.end_percent, e.length_m, ms[ms.size() / 2],
      ms[ms.size() * 95 / 100], residual / n, inliers / n, iterations / n, used / n, degenerate, mapper.dense().size());
  for (const auto& [name, value] : mapper.counters().values()) fmt::print("{} {}  ", name, value);
  fmt::print("\n");
  return 0;
}
