// Development tool, no test: how often verify_place() finds the place of a scan, and whether it ever takes another
// for it. Towns of several seeds and, if it is there, the recorded street:
//   bench_places [towns=4] [spacing=2] [few=0] [cars=0] [drift=0] [half=0] [part=0] [global=0]
// `spacing`: m between nodes; `few`: that many nodes only, about the place (0: all); `cars`: so many stand about the
// scan that did not when the nodes were made; `drift`: of the nodes, m a node; `half`: half of each scan is
// lost; `part`: part of what a scan shows need not be known; `global`: nothing is guessed.
#include <fmt/format.h>
#include <time.h>

#include <filesystem>
#include <numbers>
#include <string>

#include "services/mapper/place_recognition/verify_place.hpp"
#include "tests/services/mapper/place_recognition/place_scenes.hpp"
#include "tools/simulate/numerics/random.hpp"

namespace {

using namespace curbstone;
using test::Changes, test::Places, test::View;
constexpr double kPi = std::numbers::pi;

auto known_part = mapper::place_recognition::Known::kAll;

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

std::vector<const mapper::scan::Keyframe*> nodes_about(const Places& places, const Eigen::Vector3d& position, int few) {
  std::vector<const mapper::scan::Keyframe*> out;
  for (const mapper::scan::Keyframe& node : places.nodes) out.push_back(&node);
  if (few == 0) return out;
  std::stable_sort(out.begin(), out.end(), [&](const mapper::scan::Keyframe* a, const mapper::scan::Keyframe* b) {
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

void count(const View& view, const std::optional<mapper::place_recognition::PlaceMatch>& match, bool known, double ms,
           Tally& tally) {
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

/// Scans taken near the nodes, with a guess that is off by up to so much.
Tally seek(const Places& places, double reach, double turn, int few, simulate::numerics::Random random) {
  Tally tally;
  for (const View& view : places.near) {
    const double way = reach * std::sqrt(random.uniform()), angle = random.uniform(0, 2 * kPi);
    mapper::place_recognition::PlaceGuess guess{view.T_map_base, reach, turn};
    guess.T_map_base.translation() +=
        Eigen::Vector3d(way * std::cos(angle), way * std::sin(angle), random.uniform(-1.0, 1.0));
    guess.T_map_base.linear() = rotation_from_rpy(random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), 0) *
                                Eigen::AngleAxisd(random.uniform(-turn, turn), Eigen::Vector3d::UnitZ()) *
                                guess.T_map_base.linear();
    const auto nodes = nodes_about(places, view.T_map_base.translation(), few);
    const double begin = cpu_ms();
    const auto match = mapper::place_recognition::verify_place(view.points, guess, nodes, mapper::config::IcpConfig{},
                                                               places.lidar, known_part);
    count(view, match, true, cpu_ms() - begin, tally);
  }
  return tally;
}

/// Scans taken elsewhere, guessed to be at some node, heading as it does or against it.
Tally mistake(const Places& places, const std::vector<View>& elsewhere, double reach, double turn, int few,
              simulate::numerics::Random random) {
  Tally tally;
  for (const View& view : elsewhere) {
    const Pose& T =
        places.nodes[static_cast<std::size_t>(random.integer(0, static_cast<int>(places.nodes.size()) - 1))].T_map_base;
    const Eigen::Vector3d rpy = roll_pitch_yaw(view.T_map_base.linear());
    mapper::place_recognition::PlaceGuess guess{T, reach, turn};
    guess.T_map_base.linear() =
        rotation_from_rpy(rpy.x(), rpy.y(), roll_pitch_yaw(T.linear()).z() + (random.chance(0.5) ? kPi : 0));
    const auto nodes = nodes_about(places, T.translation(), few);
    const double begin = cpu_ms();
    const auto match = mapper::place_recognition::verify_place(view.points, guess, nodes, mapper::config::IcpConfig{},
                                                               places.lidar, known_part);
    count(view, match, false, cpu_ms() - begin, tally);
  }
  return tally;
}

/// Nothing known: the index of one drive, asked about its own places and about all others.
void seek_everywhere(const std::vector<Places>& all) {
  for (const Places& places : all) {
    mapper::place_recognition::ScanContext index;
    const auto nodes = nodes_about(places, {}, 0);
    for (std::size_t i = 0; i < nodes.size(); ++i) index.add(static_cast<int>(i), *nodes[i]->points.read());
    const auto ask = [&](const std::vector<View>& views, bool known) {
      Tally tally;
      for (const View& view : views) {
        const double begin = cpu_ms();
        const auto match = mapper::place_recognition::verify_place(
            view.points, view.T_map_base, index, nodes, mapper::config::IcpConfig{}, places.lidar, known_part);
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
    if (key == "part" && value != 0) known_part = mapper::place_recognition::Known::kPart;
    if (key == "global") everywhere = value != 0;
  }
  std::vector<Places> all;
  for (int seed = 1; seed <= towns; ++seed) all.push_back(test::town(static_cast<std::uint64_t>(seed), spacing));
  const std::string recording = "../shared/data/kitti0005_rs16";
  if (std::filesystem::exists(recording)) all.push_back(test::street(recording, spacing));
  for (Places& places : all) change(places, changes, simulate::numerics::Random(11));
  fmt::print(
      "{:<44} {:>5} {:>5} {:>5}  {:>5} {:>6}  {:>6} {:>6}  found: least score, most conflict, least inliers, "
      "overlap, most runner-up, rise\n",
      "", "asked", "found", "wrong", "m", "rad", "CPU ms", "most");
  if (everywhere) {
    seek_everywhere(all);
    return 0;
  }
  const simulate::numerics::Random random(7);
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
