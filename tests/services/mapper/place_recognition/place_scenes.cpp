#include "tests/services/mapper/place_recognition/place_scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/mapper/scan/deskew.hpp"
#include "services/mapper/scan/downsample.hpp"
#include "tools/bench/mapping/drives/scan_drive.hpp"
#include "tools/simulate/town_setup.hpp"
#include "tools/simulate/town_surroundings.hpp"

namespace curbstone::test {
namespace {

constexpr double kPi = std::numbers::pi;

mapper::scan::Keyframe node_of(const View& view) {
  mapper::scan::Keyframe node;
  node.T_map_base = view.T_map_base;
  std::vector<mapper::scan::KeyframePoint> kept;
  for (const mapper::scan::LidarPoint& p : mapper::scan::downsample(view.points, 0.2, 60.0)) {
    if (const auto packed = mapper::scan::pack(p.position)) kept.push_back(*packed);
  }
  node.points = std::move(kept);
  return node;
}

/// A scan of a vehicle that stands.
View snapshot(const simulate::TownSetup& setup, const Pose& T, double t, std::uint64_t seed) {
  simulate::TownSurroundings world(setup.town(), setup.config().lidar);
  const Pose T_base_lidar = setup.config().vehicle.T_base_lidar();
  const Pose T_world_lidar = T * T_base_lidar;
  world.prepare({t, T_world_lidar, 0, 2 * kPi});
  View view{T, {}};
  for (int column = 0; column < 900; ++column) {
    for (int ring = 0; ring < 16; ++ring) {
      const double azimuth = kPi - 2 * kPi * column / 900, elevation = (-15 + 2 * ring) * kPi / 180;
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                std::sin(elevation));
      simulate::sensors::Shot shot;
      shot.t = t, shot.laser = ring, shot.azimuth = -azimuth;
      shot.origin_world = T_world_lidar.translation();
      shot.direction_world = T_world_lidar.linear() * ray;
      shot.noise = simulate::numerics::mix_bits(
          seed ^ simulate::numerics::mix_bits(static_cast<std::uint64_t>(column * 16 + ring)));
      const simulate::devices::LidarShot hit = world.measure(shot);
      if (!(hit.range_m > 0.4F)) continue;
      const Eigen::Vector3d p = T_base_lidar * (static_cast<double>(hit.range_m) * ray);
      view.points.push_back({p.cast<float>(), 0, hit.intensity, static_cast<std::uint8_t>(ring)});
    }
  }
  return view;
}

/// Cars that were not there before: the rays that meet them end there. The lidar is at `lidar` in base_link.
void park(View& view, const Eigen::Vector3d& lidar, int cars, simulate::numerics::Random& random) {
  for (int i = 0; i < cars; ++i) {
    const double azimuth = random.uniform(-kPi, kPi), range = random.uniform(4, 18);
    const Eigen::Vector3d low(range * std::cos(azimuth) - lidar.x(), range * std::sin(azimuth) - lidar.y(), -1.73);
    const Eigen::Vector3d high =
        low + Eigen::Vector3d(random.chance(0.5) ? 4.2 : 1.8, random.chance(0.5) ? 4.2 : 1.8, 1.6);
    for (mapper::scan::LidarPoint& p : view.points) {
      const Eigen::Vector3d ray = p.position.cast<double>() - lidar;  // the whole of it is 1 long
      double enter = 0, leave = 1;
      for (int axis = 0; axis < 3; ++axis) {
        const double a = low[axis] / ray[axis], b = high[axis] / ray[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
      }
      if (enter > 0 && enter < leave) p.position = (lidar + enter * ray).cast<float>();
    }
  }
}

}  // namespace

Places town(std::uint64_t seed, double spacing) {
  const simulate::TownSetup setup(seed, 320, 0);
  Places out{fmt::format("town {}", seed), setup.config().vehicle.T_base_lidar().translation(), {}, {}, {}};
  simulate::numerics::Random random(seed);
  double s = 0, next_node = 10, next_near = 30, next_far = 260;
  Eigen::Vector3d last = setup.motion().T_world_base(0).translation();
  for (double t = 0; s < 850; t += 0.05) {
    const Pose T = setup.motion().T_world_base(t);
    s += (T.translation() - last).norm();
    last = T.translation();
    if (s < 200 && s >= next_node) {
      next_node += spacing;
      out.nodes.push_back(node_of(snapshot(setup, T, t, random.bits())));
    }
    if (s < 180 && s >= next_near) {
      next_near += 5;
      const bool oncoming = random.chance(0.4);
      Pose off = Pose::Identity();
      off.translation().y() = random.uniform(-0.5, oncoming ? 3.5 : 2.0);
      off.linear() = rotation_from_rpy(0, 0, random.uniform(-0.2, 0.2) + (oncoming ? kPi : 0));
      out.near.push_back(snapshot(setup, T * off, t + 400, random.bits()));
    }
    const bool back = std::any_of(out.nodes.begin(), out.nodes.end(), [&](const mapper::scan::Keyframe& node) {
      return (T.translation() - node.T_map_base.translation()).norm() < 50;
    });
    if (s >= next_far && !back) {
      next_far += 8;
      out.far.push_back(snapshot(setup, T, t, random.bits()));
    }
    if (t > 318) break;
  }
  return out;
}

Places street(const std::string& folder, double spacing) {
  const bench::mapping::drives::ScanDrive drive(folder, folder + "/reference_poses.txt", folder + "/times.txt");
  Places out{drive.name, Eigen::Vector3d::Zero(), {}, {}, {}};
  const evaluate::truth::Trajectory& truth = drive.truth();
  double s = 0, next = 0;
  for (std::size_t i = 0; i + 1 < truth.size(); ++i) {
    if (i > 0) s += (truth[i].pose.translation() - truth[i - 1].pose.translation()).norm();
    const mapper::scan::Scan scan = drive.scan(i);
    const double stride = 1e-6 * static_cast<double>(truth[i + 1].utime - truth[i].utime);
    const mapper::scan::Twist twist = mapper::scan::twist_of(truth[i].pose.inverse() * truth[i + 1].pose, stride);
    const double sweep = 1e-6 * static_cast<double>(scan.end - scan.start);
    const View view{truth[i].pose * mapper::scan::move(twist, 0.5 * sweep),
                    mapper::scan::deskew(scan.points, Pose::Identity(), mapper::scan::steady_sweep(twist, sweep))};
    if (s < 30 && s >= next) {
      next = s + spacing;
      out.nodes.push_back(node_of(view));
    } else if (s < 28) {
      out.near.push_back(view);
    } else if (s > 45) {
      out.far.push_back(view);
    }
  }
  return out;
}

void change(Places& places, const Changes& changes, simulate::numerics::Random random) {
  for (std::vector<View>* views : {&places.near, &places.far}) {
    for (View& view : *views) {
      park(view, places.lidar, changes.cars, random);
      if (!changes.half) continue;
      const double from = random.uniform(-kPi, kPi);
      std::erase_if(view.points, [&](const mapper::scan::LidarPoint& p) {
        return std::remainder(
                   std::atan2(static_cast<double>(p.position.y()), static_cast<double>(p.position.x())) - from,
                   2 * kPi) > 0;
      });
    }
  }
  if (places.nodes.empty() || !(changes.drift > 0)) return;
  std::vector<Pose> before;
  Pose off = Pose::Identity();
  for (mapper::scan::Keyframe& node : places.nodes) {
    before.push_back(node.T_map_base);
    node.T_map_base = node.T_map_base * off;
    off.translation() += changes.drift * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    off.linear() = off.linear() * rotation_from_rpy(0, 0, 0.1 * changes.drift * random.normal());
  }
  for (View& view : places.near) {  // its place is where its surroundings are now
    const auto distance = [&](const Pose& T) { return (T.translation() - view.T_map_base.translation()).norm(); };
    const auto nearest = std::min_element(before.begin(), before.end(),
                                          [&](const Pose& a, const Pose& b) { return distance(a) < distance(b); });
    const mapper::scan::Keyframe& node = places.nodes[static_cast<std::size_t>(nearest - before.begin())];
    view.T_map_base = node.T_map_base * nearest->inverse() * view.T_map_base;
  }
}

}  // namespace curbstone::test
