// Development tool, no test: how often find_place() finds the place of a revolution, and whether it ever takes another
// for it. Towns of several seeds and, if it is there, the recorded street:
//   bench_places [towns=4] [spacing=2] [few=0] [cars=0] [drift=0] [half=0] [global=0]
// `spacing`: m between nodes; `few`: that many nodes only, about the place (0: all); `cars`: so many stand about the
// revolution that did not when the nodes were made; `drift`: of the nodes, m a node; `half`: half of each revolution is
// lost; `global`: nothing is guessed.
#include <fmt/format.h>
#include <time.h>

#include <filesystem>
#include <numbers>
#include <string>

#include "services/mapper/downsample.hpp"
#include "services/mapper/find_place.hpp"
#include "tools/bench/mapping/scan_drive.hpp"
#include "tools/simulate/random.hpp"
#include "tools/simulate/town_setup.hpp"
#include "tools/simulate/town_surroundings.hpp"

namespace {

using namespace curbstone;
constexpr double kPi = std::numbers::pi;

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

struct View {
  Pose T_map_base;
  std::vector<LidarPoint> points;
};

/// A drive's nodes, revolutions taken near them, and revolutions taken out of their sight.
struct Places {
  std::string name;
  Eigen::Vector3d lidar;
  std::vector<MapNode> nodes;
  std::vector<View> near, far;
};

MapNode node_of(const View& view) {
  MapNode node;
  node.T_map_base = view.T_map_base;
  for (const LidarPoint& p : downsample(view.points, 0.2, 60.0)) {
    if (const auto packed = pack(p.position)) node.points.push_back(*packed);
  }
  return node;
}

/// A revolution of a vehicle that stands.
View snapshot(const TownSetup& setup, const Pose& T, double t, std::uint64_t seed) {
  TownSurroundings world(setup.town(), setup.config().lidar);
  const Pose T_base_lidar = setup.config().vehicle.T_base_lidar();
  const Pose T_world_lidar = T * T_base_lidar;
  world.prepare({t, T_world_lidar, 0, 2 * kPi});
  View view{T, {}};
  for (int column = 0; column < 900; ++column) {
    for (int ring = 0; ring < 16; ++ring) {
      const double azimuth = kPi - 2 * kPi * column / 900, elevation = (-15 + 2 * ring) * kPi / 180;
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                std::sin(elevation));
      Shot shot;
      shot.t = t, shot.laser = ring, shot.azimuth = -azimuth;
      shot.origin_world = T_world_lidar.translation();
      shot.direction_world = T_world_lidar.linear() * ray;
      shot.noise = mix_bits(seed ^ mix_bits(static_cast<std::uint64_t>(column * 16 + ring)));
      const Rs16Shot hit = world.measure(shot);
      if (!(hit.range_m > 0.4F)) continue;
      const Eigen::Vector3d p = T_base_lidar * (static_cast<double>(hit.range_m) * ray);
      view.points.push_back({p.cast<float>(), 0, hit.intensity, static_cast<std::uint8_t>(ring)});
    }
  }
  return view;
}

/// Nodes along 190 m; revolutions from either lane, in either direction, minutes later.
Places town(std::uint64_t seed, double spacing) {
  const TownSetup setup(seed, 320, 0);
  Places out{fmt::format("town {}", seed), setup.config().vehicle.T_base_lidar().translation(), {}, {}, {}};
  Random random(seed);
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
    const bool back = std::any_of(out.nodes.begin(), out.nodes.end(), [&](const MapNode& node) {
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

/// Every third scan or so of the first 30 m is a node; the others are near, those from 45 m on far.
Places street(const std::string& folder, double spacing) {
  const ScanDrive drive(folder, folder + "/reference_poses.txt", folder + "/times.txt");
  Places out{drive.name, Eigen::Vector3d::Zero(), {}, {}, {}};
  const Trajectory& truth = drive.truth();
  double s = 0, next = 0;
  for (std::size_t i = 0; i + 1 < truth.size(); ++i) {
    if (i > 0) s += (truth[i].pose.translation() - truth[i - 1].pose.translation()).norm();
    const Revolution revolution = drive.revolution(i);
    const double stride = 1e-6 * static_cast<double>(truth[i + 1].utime - truth[i].utime);
    const Twist twist = twist_of(truth[i].pose.inverse() * truth[i + 1].pose, stride);
    const double sweep = 1e-6 * static_cast<double>(revolution.end - revolution.start);
    const View view{truth[i].pose * move(twist, 0.5 * sweep),
                    deskew(revolution.points, Pose::Identity(), steady_sweep(twist, sweep))};
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

/// Cars that were not there before: the rays that meet them end there. The lidar is at `lidar` in base_link.
void park(View& view, const Eigen::Vector3d& lidar, int cars, Random& random) {
  for (int i = 0; i < cars; ++i) {
    const double azimuth = random.uniform(-kPi, kPi), range = random.uniform(4, 18);
    const Eigen::Vector3d low(range * std::cos(azimuth) - lidar.x(), range * std::sin(azimuth) - lidar.y(), -1.73);
    const Eigen::Vector3d high =
        low + Eigen::Vector3d(random.chance(0.5) ? 4.2 : 1.8, random.chance(0.5) ? 4.2 : 1.8, 1.6);
    for (LidarPoint& p : view.points) {
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

/// What happened since the nodes were made.
struct Changes {
  int cars = 0;
  double drift = 0;
  bool half = false;
};

void change(Places& places, const Changes& changes, Random random) {
  for (std::vector<View>* views : {&places.near, &places.far}) {
    for (View& view : *views) {
      park(view, places.lidar, changes.cars, random);
      if (!changes.half) continue;
      const double from = random.uniform(-kPi, kPi);
      std::erase_if(view.points, [&](const LidarPoint& p) {
        return std::remainder(
                   std::atan2(static_cast<double>(p.position.y()), static_cast<double>(p.position.x())) - from,
                   2 * kPi) > 0;
      });
    }
  }
  if (places.nodes.empty() || !(changes.drift > 0)) return;
  std::vector<Pose> before;
  Pose off = Pose::Identity();
  for (MapNode& node : places.nodes) {
    before.push_back(node.T_map_base);
    node.T_map_base = node.T_map_base * off;
    off.translation() += changes.drift * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    off.linear() = off.linear() * rotation_from_rpy(0, 0, 0.1 * changes.drift * random.normal());
  }
  for (View& view : places.near) {  // its place is where its surroundings are now
    const auto distance = [&](const Pose& T) { return (T.translation() - view.T_map_base.translation()).norm(); };
    const auto nearest = std::min_element(before.begin(), before.end(),
                                          [&](const Pose& a, const Pose& b) { return distance(a) < distance(b); });
    const MapNode& node = places.nodes[static_cast<std::size_t>(nearest - before.begin())];
    view.T_map_base = node.T_map_base * nearest->inverse() * view.T_map_base;
  }
}

std::vector<const MapNode*> nodes_about(const Places& places, const Eigen::Vector3d& position, int few) {
  std::vector<const MapNode*> out;
  for (const MapNode& node : places.nodes) out.push_back(&node);
  if (few == 0) return out;
  std::stable_sort(out.begin(), out.end(), [&](const MapNode* a, const MapNode* b) {
    return (a->T_map_base.translation() - position).norm() < (b->T_map_base.translation() - position).norm();
  });
  out.resize(std::min(out.size(), static_cast<std::size_t>(few)));
  return out;
}

/// What became of many queries.
struct Tally {
  int queries = 0, found = 0, wrong = 0;
  double worst_m = 0, worst_rad = 0, ms = 0, most_ms = 0;
  double max_rise = 0;
  double min_score = 1, max_conflict = 0, min_inliers = 1, min_overlap = 1, max_runner_up = 0;
  void print(const std::string& name) const {
    fmt::print("{:<44} {:5} {:5} {:5}  {:.3f} {:.4f}  {:6.0f} {:6.0f}", name, queries, found, wrong, worst_m, worst_rad,
               ms / std::max(queries, 1), most_ms);
    if (found > 0)
      fmt::print("  {:.2f} {:.2f} {:.2f} {:.2f} {:.2f} {:.2f}", min_score, max_conflict, min_inliers, min_overlap,
                 max_runner_up, max_rise);
    fmt::print("\n");
    fflush(stdout);
  }
};

void count(const View& view, const std::optional<PlaceMatch>& match, bool known, double ms, Tally& tally) {
  ++tally.queries;
  tally.ms += ms;
  tally.most_ms = std::max(tally.most_ms, ms);
  if (!match) return;
  const Pose error = view.T_map_base.inverse() * match->registration.T_map_base;
  const double rad = angle_of(error);
  if (!known || error.translation().norm() > 0.3 || rad > 0.02) {
    ++tally.wrong;
    fmt::print("WRONG: {:.2f} m {:.3f} rad, score {:.2f} conflict {:.2f} inliers {:.2f} runner-up {:.2f}\n",
               error.translation().norm(), rad, match->score, match->conflict, match->registration.inlier_ratio,
               match->runner_up);
    return;
  }
  ++tally.found;
  tally.worst_m = std::max(tally.worst_m, error.translation().norm());
  tally.worst_rad = std::max(tally.worst_rad, rad);
  tally.min_score = std::min(tally.min_score, match->score);
  tally.max_rise = std::max(tally.max_rise, std::abs(match->rise));
  tally.max_conflict = std::max(tally.max_conflict, match->conflict);
  tally.min_inliers = std::min(tally.min_inliers, match->registration.inlier_ratio);
  tally.min_overlap = std::min(tally.min_overlap, match->registration.overlap);
  tally.max_runner_up = std::max(tally.max_runner_up, match->runner_up);
}

/// Revolutions taken near the nodes, with a guess that is off by up to so much.
Tally seek(const Places& places, double reach, double turn, int few, Random random) {
  Tally tally;
  for (const View& view : places.near) {
    const double way = reach * std::sqrt(random.uniform()), angle = random.uniform(0, 2 * kPi);
    PlaceGuess guess{view.T_map_base, reach, turn};
    guess.T_map_base.translation() +=
        Eigen::Vector3d(way * std::cos(angle), way * std::sin(angle), random.uniform(-1.0, 1.0));
    guess.T_map_base.linear() = rotation_from_rpy(random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), 0) *
                                Eigen::AngleAxisd(random.uniform(-turn, turn), Eigen::Vector3d::UnitZ()) *
                                guess.T_map_base.linear();
    const auto nodes = nodes_about(places, view.T_map_base.translation(), few);
    const double begin = cpu_ms();
    const auto match = find_place(view.points, guess, nodes, IcpConfig{}, places.lidar);
    count(view, match, true, cpu_ms() - begin, tally);
  }
  return tally;
}

/// Revolutions taken elsewhere, guessed to be at some node, heading as it does or against it.
Tally mistake(const Places& places, const std::vector<View>& elsewhere, double reach, double turn, int few,
              Random random) {
  Tally tally;
  for (const View& view : elsewhere) {
    const Pose& T =
        places.nodes[static_cast<std::size_t>(random.integer(0, static_cast<int>(places.nodes.size()) - 1))].T_map_base;
    const Eigen::Vector3d rpy = roll_pitch_yaw(view.T_map_base.linear());
    PlaceGuess guess{T, reach, turn};
    guess.T_map_base.linear() =
        rotation_from_rpy(rpy.x(), rpy.y(), roll_pitch_yaw(T.linear()).z() + (random.chance(0.5) ? kPi : 0));
    const auto nodes = nodes_about(places, T.translation(), few);
    const double begin = cpu_ms();
    const auto match = find_place(view.points, guess, nodes, IcpConfig{}, places.lidar);
    count(view, match, false, cpu_ms() - begin, tally);
  }
  return tally;
}

/// Nothing known: the index of one drive, asked about its own places and about all others.
void seek_everywhere(const std::vector<Places>& all) {
  for (const Places& places : all) {
    PlaceIndex index;
    const auto nodes = nodes_about(places, {}, 0);
    for (std::size_t i = 0; i < nodes.size(); ++i) index.add(static_cast<int>(i), nodes[i]->points);
    const auto ask = [&](const std::vector<View>& views, bool known) {
      Tally tally;
      for (const View& view : views) {
        const double begin = cpu_ms();
        const auto match = find_place(view.points, view.T_map_base, index, nodes, IcpConfig{}, places.lidar);
        count(view, match, known, cpu_ms() - begin, tally);
      }
      return tally;
    };
    ask(places.near, true).print(places.name + ", anywhere");
    ask(places.far, false).print(places.name + ", anywhere, from elsewhere in it");
    for (const Places& other : all) {
      if (&other != &places) ask(other.near, false).print(places.name + ", anywhere, from " + other.name);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  int towns = 4, few = 0;
  double spacing = 2;
  bool everywhere = false;
  Changes changes;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto equals = argument.find('=');
    const std::string key = argument.substr(0, equals);
    const double value = equals == std::string::npos ? 1 : std::stod(argument.substr(equals + 1));
    if (key == "towns") towns = static_cast<int>(value);
    if (key == "few") few = static_cast<int>(value);
    if (key == "spacing") spacing = value;
    if (key == "cars") changes.cars = static_cast<int>(value);
    if (key == "drift") changes.drift = value;
    if (key == "half") changes.half = value != 0;
    if (key == "global") everywhere = value != 0;
  }
  std::vector<Places> all;
  for (int seed = 1; seed <= towns; ++seed) all.push_back(town(static_cast<std::uint64_t>(seed), spacing));
  const std::string recording = "../shared/data/kitti0005_rs16";
  if (std::filesystem::exists(recording)) all.push_back(street(recording, spacing));
  for (Places& places : all) change(places, changes, Random(11));
  fmt::print(
      "{:<44} {:>5} {:>5} {:>5}  {:>5} {:>6}  {:>6} {:>6}  found: least score, most conflict, least inliers, "
      "overlap, most runner-up, rise\n",
      "", "asked", "found", "wrong", "m", "rad", "CPU ms", "most");
  if (everywhere) {
    seek_everywhere(all);
    return 0;
  }
  const Random random(7);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Places& places = all[i];
    for (const auto& [reach, turn] : {std::pair{2.0, 0.1}, {5.0, 0.175}, {5.0, 0.35}, {10.0, 0.5}, {15.0, kPi}}) {
      if (few > 0 && reach > 5) continue;
      seek(places, reach, turn, few, random)
          .print(fmt::format("{}, {} m {:.0f} deg", places.name, reach, turn * 180 / kPi));
    }
    mistake(places, places.far, 5, 0.35, few, random).print(places.name + ", from elsewhere in it");
    mistake(places, all[(i + 1) % all.size()].near, 5, 0.35, few, random)
        .print(places.name + ", from " + all[(i + 1) % all.size()].name);
  }
}
