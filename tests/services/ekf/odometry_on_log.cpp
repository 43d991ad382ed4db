// odometry_on_log LOG [TRUTH_FOLDER [KEY=VALUE...]]: runs the ekf node on a log's IMU and WHEELS, with fuse_map=true
// the mapper on its LIDAR_POINTS as well, and prints how far odometry and map poses are from the truth: for tuning by
// hand, not a test.

#include <Eigen/Cholesky>
#include <chrono>
#include <cstdio>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <exception>

#include "common/bus/local_bus.hpp"
#include "common/log/log_reader.hpp"
#include "common/log/message_order.hpp"
#include "services/ekf/ekf_node.hpp"
#include "services/mapper/mapper_node.hpp"
#include "tools/evaluate/truth/trajectory.hpp"
#include "tools/evaluate/truth/truth.hpp"

using namespace curbstone;

namespace {

/// What odometry_t does not tell.
struct Calibration {
  ekf::model::NavState mean;
  double axle_sigma;  // m
};

struct Run {
  std::vector<odometry_t> odometry;
  std::vector<Calibration> calibration;  // one for each
  evaluate::truth::Trajectory map;
  double seconds = 0.0;  // of CPU in the node
};

Run run(const std::string& log_file, ekf::EkfNode& node, mapper::MapperNode* mapper, LocalBus& bus) {
  Run out;
  bus.subscribe<odometry_t>("ODOMETRY", [&](const odometry_t& m) {
    out.odometry.push_back(m);
    const ekf::model::Belief& belief = node.filter().filter().belief();
    out.calibration.push_back({belief.mean, std::sqrt(belief.covariance(ekf::model::kAxle, ekf::model::kAxle))});
  });
  bus.subscribe<map_pose_t>("MAP_POSE", [&](const map_pose_t& m) {
    out.map.push_back({m.utime, pose_from_arrays(m.map_base_position, m.map_base_orientation)});
  });
  LogReader log(log_file);
  MessageOrder order;
  const auto deliver = [&](const LogEvent& event) {
    const auto begin = std::chrono::steady_clock::now();
    bus.inject(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    bus.dispatch();
    out.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  while (auto event = log.next()) {
    const bool wanted = event->channel == "IMU" || event->channel == "WHEELS" ||
                        (mapper != nullptr && event->channel == "LIDAR_POINTS");
    if (!wanted) continue;
    order.push(std::move(*event));
    while (const auto ready = order.pop()) deliver(*ready);
  }
  while (const auto ready = order.pop_rest()) deliver(*ready);
  node.finish();
  bus.dispatch();
  return out;
}

void compare(const Run& result, const evaluate::truth::Trajectory& truth) {
  evaluate::truth::Trajectory estimate;
  for (const odometry_t& m : result.odometry)
    estimate.push_back({m.utime, pose_from_arrays(m.position, m.orientation)});
  const evaluate::truth::TrajectoryErrors errors =
      evaluate::truth::trajectory_errors(evaluate::truth::pair_up(truth, estimate));
  std::printf("distance %.1f m, ATE %.3f m, RPE %.3f %%, %.5f deg/m, end %.3f %%\n", errors.distance_m, errors.ate_m,
              errors.rpe_percent, errors.rpe_deg_per_m, errors.end_percent);
  std::optional<Pose> T_truth_odom;
  std::int64_t next = 0;
  int looks = 0;
  double nees = 0.0;
  for (std::size_t i = 0; i < result.odometry.size(); ++i) {
    const odometry_t& m = result.odometry[i];
    const auto T_truth_base = evaluate::truth::pose_at(truth, m.utime);
    if (!T_truth_base) continue;
    const Pose T_odom_base = pose_from_arrays(m.position, m.orientation);
    const Eigen::Vector3d rpy_truth = roll_pitch_yaw(T_truth_base->linear());
    if (!T_truth_odom) {  // both level: odom differs from the truth's frame by position and yaw
      T_truth_odom = Pose::Identity();
      T_truth_odom->translation() = T_truth_base->translation();
      T_truth_odom->linear() = rotation_from_rpy(0, 0, rpy_truth.z());
    }
    if (m.utime < next) continue;
    next = m.utime + 250'000;
    ++looks;
    const Pose expected = T_truth_odom->inverse() * *T_truth_base;
    const Eigen::Vector3d e = T_odom_base.translation() - expected.translation();
    const Eigen::Vector3d r = so3_log(Eigen::Quaterniond(expected.linear().transpose() * T_odom_base.linear()));
    const Eigen::Matrix<double, 6, 6> covariance =
        Eigen::Map<const Eigen::Matrix<float, 6, 6>>(m.pose_covariance).cast<double>() +
        1e-8 * Eigen::Matrix<double, 6, 6>::Identity();  // at the origin it is exact
    Eigen::Matrix<double, 6, 1> error;
    error << e, r;
    nees += error.dot(covariance.ldlt().solve(error));
    const auto sigma = [&](int k) { return std::sqrt(static_cast<double>(m.pose_covariance[k])); };
    const double d = 57.29578;
    std::printf(
        "%7.2f s  error x %7.3f y %7.3f z %7.3f m (sigma %.3f %.3f %.3f)  rot %6.3f %6.3f %6.3f deg (sigma %.3f %.3f "
        "%.3f)  v %.2f flags %d  axle %.3f (%.3f)\n",
        1e-6 * static_cast<double>(m.utime - result.odometry.front().utime), e.x(), e.y(), e.z(), sigma(0), sigma(7),
        sigma(14), d * r.x(), d * r.y(), d * r.z(), d * sigma(21), d * sigma(28), d * sigma(35), m.velocity[0], m.flags,
        result.calibration[i].mean.axle, result.calibration[i].axle_sigma);
  }
  if (looks > 0) std::printf("NEES of the pose, mean: %.1f (expected 6)\n", nees / looks);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: odometry_on_log LOG [TRUTH_FOLDER [KEY=VALUE...]]\n");
    return 2;
  }
  ConfigOf<ekf::base::EkfConfig> config;
  for (int i = 3; i < argc; ++i) set_config_value(argv[i], config);
  LocalBus bus;
  ekf::EkfNode node(config.value, bus);
  node.connect(bus);
  std::optional<mapper::MapperNode> mapper;
  if (config.value.fuse_map) {
    mapper.emplace(mapper::config::MapperConfig{}, bus);
    mapper->connect(bus);
  }
  const Run result = run(argv[1], node, mapper ? &*mapper : nullptr, bus);
  if (result.odometry.empty()) throw std::runtime_error("no odometry");
  if (argc > 2) {
    const evaluate::truth::Trajectory truth = evaluate::truth::load_truth(argv[2]).poses;
    compare(result, truth);
    if (mapper) {
      const evaluate::truth::TrajectoryErrors errors =
          evaluate::truth::trajectory_errors(evaluate::truth::pair_up(truth, result.map));
      std::printf("map: ATE %.4f m, RPE %.4f %%, %.5f deg/m, end %.4f %%\n", errors.ate_m, errors.rpe_percent,
                  errors.rpe_deg_per_m, errors.end_percent);
    }
  }
  const double span = 1e-6 * static_cast<double>(result.odometry.back().utime - result.odometry.front().utime);
  std::printf("%zu estimates over %.1f s, %.4f cores\n", result.odometry.size(), span, result.seconds / span);
  const ekf::model::NavState& state = node.filter().filter().belief().mean;
  std::printf("wheel scale %.4f %.4f %.4f, axle %.3f m\n", state.wheel_scale.x(), state.wheel_scale.y(),
              state.wheel_scale.z(), state.axle);
  const NodeReport report = node.report();
  for (const auto& [name, value] : report.counters.values())
    std::printf("  %s %ld\n", name.c_str(), static_cast<long>(value));
  for (const std::string& fault : report.faults) std::printf("  fault: %s\n", fault.c_str());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "odometry_on_log: %s\n", error.what());
  return 1;
}
