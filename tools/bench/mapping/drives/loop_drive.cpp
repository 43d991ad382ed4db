#include "tools/bench/mapping/drives/loop_drive.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "tools/bench/mapping/drives/log_player.hpp"
#include "tools/simulate/log_recorder.hpp"

namespace curbstone::bench::mapping::drives {
namespace {

constexpr std::int64_t kStart = 1'750'000'000'000'000;  // us
constexpr double kTruthPeriod = 0.05;                   // s

simulate::rig::SimulateConfig slipping(double slips) {
  simulate::rig::SimulateConfig config;
  config.wheels.slips_per_minute = slips;
  return config;
}

double first_return(const LoopDrive& drive) {
  std::vector<std::pair<double, Eigen::Vector3d>> places;  // by distance driven, one per metre
  for (const evaluate::truth::StampedPose& at : drive.truth()) {
    const double way = drive.way(at.utime);
    if (!places.empty() && way < places.back().first + 1.0) continue;
    for (const auto& [before, place] : places) {
      if (before > way - LoopDrive::kApart) break;
      if ((at.pose.translation() - place).norm() < LoopDrive::kNear) return way;
    }
    places.emplace_back(way, at.pose.translation());
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

LoopDrive::LoopDrive(const simulate::TownTour& tour, double slips)
    : setup_(tour, kStart, slipping(slips)),
      lap_(tour.opposite ? std::numeric_limits<double>::infinity()
                         : simulate::motion::TownRoute::around(setup_.town()).length()) {
  name = fmt::format("loop{:.0f}{}-{}", tour.loop, tour.opposite ? "opp" : "", tour.seed);
  prior = "ekf";
  for (double t = 0; t <= setup_.drive().seconds; t += kTruthPeriod)
    truth_.push_back({kStart + std::llround(t * 1e6), setup_.motion().T_world_base(t)});
  returns_ = first_return(*this);
}

double LoopDrive::seconds(std::int64_t utime) {
  return static_cast<double>(utime - kStart) * 1e-6;
}

void LoopDrive::play(const Take& take) const {
  const auto source = [&](const std::function<void(LogEvent)>& hand_over) {
    simulate::record_drive(setup_.drive(),
                           [&](const std::string& channel, const void* data, int size, std::int64_t log_utime) {
                             const auto* bytes = static_cast<const std::uint8_t*>(data);
                             hand_over({log_utime, channel, {bytes, bytes + size}});
                           });
  };
  play_events(source, true, take);
}

}  // namespace curbstone::bench::mapping::drives
