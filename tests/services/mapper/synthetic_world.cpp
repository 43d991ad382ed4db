#include "tests/services/mapper/synthetic_world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/config/vehicle.hpp"

namespace curbstone::test {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kColumns = 900;

/// A number in about -1.7..1.7 with variance 1, from the place in the stream alone.
double noise_of(std::uint64_t n) {
  n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9ULL;
  n = (n ^ (n >> 27)) * 0x94d049bb133111ebULL;
  n ^= n >> 31;
  return (static_cast<double>(n >> 11) / 9007199254740992.0 - 0.5) * std::sqrt(12.0);
}

/// As SyntheticWorld::range(), of these boxes.
double first_hit(bool ground, const std::vector<const SyntheticWorld::Box*>& boxes, const Eigen::Vector3d& origin,
                 const Eigen::Vector3d& direction) {
  double best = ground && direction.z() < 0 && origin.z() > 0 ? -origin.z() / direction.z() : kInfinity;
  for (const SyntheticWorld::Box* box : boxes) {
    double enter = 0;
    double leave = kInfinity;
    for (int axis = 0; axis < 3 && enter < std::min(leave, best); ++axis) {  // until it is missed, or behind another
      const double a = (box->low[axis] - origin[axis]) / direction[axis];
      const double b = (box->high[axis] - origin[axis]) / direction[axis];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter < leave && enter > 0) best = std::min(best, enter);
  }
  return best < 100 ? best : kInfinity;
}

/// The boxes that a column of rays may meet: those that reach the half plane in which they lie. Without this the tests
/// of the mapper spend three quarters of their time on rays and boxes far apart.
class Column {
 public:
  explicit Column(const std::vector<SyntheticWorld::Box>& boxes) {
    for (const SyntheticWorld::Box& box : boxes)
      all_.push_back({&box, 0.5 * (box.low + box.high), 0.5 * (box.high - box.low)});
  }
  /// The half plane begins at the upright through `origin`, goes `ahead`, and `aside` is its normal: unit vectors.
  const std::vector<const SyntheticWorld::Box*>& at(const Eigen::Vector3d& origin, const Eigen::Vector3d& ahead,
                                                    const Eigen::Vector3d& aside) {
    constexpr double kMargin = 0.001;  // m, far beyond rounding
    met_.clear();
    for (const Whole& whole : all_) {
      const Eigen::Vector3d to = whole.middle - origin;
      const bool meets = std::abs(aside.dot(to)) < aside.cwiseAbs().dot(whole.half) + kMargin &&
                         ahead.dot(to) > -ahead.cwiseAbs().dot(whole.half) - kMargin;
      if (meets) met_.push_back(whole.box);
    }
    return met_;
  }

 private:
  struct Whole {
    const SyntheticWorld::Box* box;
    Eigen::Vector3d middle, half;
  };
  std::vector<Whole> all_;
  std::vector<const SyntheticWorld::Box*> met_;
};

}  // namespace

double SyntheticWorld::range(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  std::vector<const Box*> all;
  for (const Box& box : boxes) all.push_back(&box);
  return first_hit(ground, all, origin, direction);
}

std::vector<lidar_points_t> SyntheticWorld::packets(const Trajectory& trajectory, const Pose& T_base_lidar,
                                                    int revolution, double start, double period) const {
  std::vector<lidar_points_t> out(kPackets);
  Column seen(boxes);
  for (int column = 0; column < kColumns; ++column) {
    lidar_points_t& packet = out[static_cast<std::size_t>(column / 24)];
    const double time = start + period * column / kColumns;
    if (column % 24 == 0) {
      packet.utime = kEpoch + std::llround(time * 1e6);
      packet.packet = revolution * kPackets + column / 24;
      packet.revolution = revolution;
    }
    const Pose T_world_lidar = trajectory(time) * T_base_lidar;
    const double azimuth = kPi - 2 * kPi * column / kColumns;
    const double cosine = std::cos(azimuth), sine = std::sin(azimuth);
    const std::vector<const Box*>& near =
        seen.at(T_world_lidar.translation(), T_world_lidar.linear() * Eigen::Vector3d(cosine, sine, 0),
                T_world_lidar.linear() * Eigen::Vector3d(-sine, cosine, 0));
    for (int ring = 0; ring < 16; ++ring) {
      const double elevation = (-15 + 2 * ring) * kPi / 180;
      const Eigen::Vector3d ray(std::cos(elevation) * cosine, std::cos(elevation) * sine, std::sin(elevation));
      double r = first_hit(ground, near, T_world_lidar.translation(), T_world_lidar.linear() * ray);
      if (!std::isfinite(r)) continue;
      r += noise * noise_of(static_cast<std::uint64_t>((revolution * kColumns + column) * 16 + ring) + 1);
      const Eigen::Vector3f p = (r * ray).cast<float>();
      packet.x.push_back(p.x());
      packet.y.push_back(p.y());
      packet.z.push_back(p.z());
      packet.time_offset.push_back(static_cast<float>(period * (column % 24) / kColumns));
      packet.intensity.push_back(static_cast<std::uint8_t>(10 * ring));
      packet.ring.push_back(static_cast<std::uint8_t>(ring));
    }
  }
  for (lidar_points_t& packet : out) packet.num_points = static_cast<std::int32_t>(packet.x.size());
  return out;
}

std::vector<mapper::scan::LidarPoint> SyntheticWorld::snapshot(const Pose& T_world_base,
                                                               const Pose& T_base_lidar) const {
  std::vector<mapper::scan::LidarPoint> points;
  for (const lidar_points_t& packet : packets([&](double) { return T_world_base; }, T_base_lidar, 0, 0, 0.05)) {
    for (std::size_t i = 0; i < packet.x.size(); ++i) {
      const Eigen::Vector3d p(packet.x[i], packet.y[i], packet.z[i]);
      points.push_back({(T_base_lidar * p).cast<float>(), 0, packet.intensity[i], packet.ring[i]});
    }
  }
  return points;
}

SyntheticWorld street() {
  SyntheticWorld world;
  world.boxes = {
      {{-60, 8, 0}, {18, 20, 9}},      // fronts on the left, with a gap
      {{24, 8, 0}, {70, 20, 9}},       //
      {{-60, -20, 0}, {70, -9, 9}},    // and on the right
      {{40, -9, 0}, {50, 8, 6}},       // the street ends
      {{-40, -9, 0}, {-35, 8, 6}},     //
      {{6, 4, 0}, {10, 5.8, 1.5}},     // parked cars
      {{-8, -6, 0}, {-4, -4.2, 1.5}},  //
      {{14, -5, 0}, {14.3, -4.7, 5}},  // a pole
      {{20, 6.5, 0}, {21, 7, 3}},      // a sign
  };
  return world;
}

SyntheticWorld tunnel() {
  SyntheticWorld world;
  world.boxes = {{{-1000, 4, -1}, {1000, 6, 8}}, {{-1000, -6, -1}, {1000, -4, 8}}};
  return world;
}

SyntheticWorld plain() {
  return {};
}

Pose default_lidar() {
  return VehicleConfig{}.T_base_lidar();
}

Pose pose(double x, double y, double z, double roll, double pitch, double yaw) {
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(x, y, z);
  T.linear() = rotation_from_rpy(roll, pitch, yaw);
  return T;
}

}  // namespace curbstone::test
