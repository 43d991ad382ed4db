#include "tests/services/ekf/harmless_drives.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/services/ekf/late_stamps.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf {

namespace {

constexpr double kSeconds = 80.0;
constexpr double kIce = 45.0;        // s, when it comes upon it
constexpr double kIceSeconds = 6.0;  // that it lasts

Drive town(const std::function<void(TownDriveOptions&)>& change, unsigned number = 1) {
  TownDriveOptions options;
  options.seconds = kSeconds;
  options.town = number;
  options.seed = 3000 + number;
  if (change) change(options);
  return simulate_town_drive(options, VehicleConfig());
}

/// As it is, which many drives begin with: simulated once.
const Drive& plain_town(unsigned number = 1) {
  static std::map<unsigned, Drive> drives;
  const auto known = drives.find(number);
  return known != drives.end() ? known->second : drives.emplace(number, town({}, number)).first->second;
}

/// Adds to each wheel what it turns beyond its way: rad/s by the time and the true speed (m/s).
Drive turning_beyond(Drive drive, const std::function<std::array<double, 2>(double, double)>& rate) {
  std::array<double, 2> added{};
  for (std::size_t i = 1; i < drive.wheels.size(); ++i) {
    const double t = base::seconds_between(drive.wheels.front().utime, drive.wheels[i].utime);
    const double dt = base::seconds_between(drive.wheels[i - 1].utime, drive.wheels[i].utime);
    const double speed = drive.truth[std::min(i, drive.truth.size() - 1)].velocity.x();
    const std::array<double, 2> more = rate(t, speed);
    for (std::size_t wheel = 0; wheel < 2; ++wheel) {
      added[wheel] += more[wheel] * dt;
      drive.wheels[i].angle[wheel] += added[wheel];
    }
  }
  return drive;
}

/// On ice both wheels turn (1 + share) times as fast as their way: they spin, or slide.
Drive on_ice(std::array<double, 2> share) {
  const double radius = VehicleConfig().wheel_radius;
  return turning_beyond(plain_town(), [=](double t, double speed) -> std::array<double, 2> {
    if (t < kIce || t > kIce + kIceSeconds) return {};
    const double grip = std::clamp(std::min(t - kIce, kIce + kIceSeconds - t) / 0.3, 0.0, 1.0);
    return {grip * share[0] * speed / radius, grip * share[1] * speed / radius};
  });
}

/// It stands on a jack from 2 s after a standstill has begun, and its wheels turn.
Drive on_a_jack(std::array<double, 2> speed) {
  constexpr std::size_t kWheelsTurn = 1200;  // samples: 12 s
  Drive drive = simulate_drive({.seconds = 60.0, .stop_at = 25.0}, VehicleConfig());
  // The standstill of 4 s is made longer by its own samples.
  Drive out;
  constexpr std::size_t kAt = 2650, kSpan = 100;
  std::int64_t later = 0;
  std::array<double, 2> turned{};
  const auto append = [&](std::size_t i) {
    out.imu.push_back(drive.imu[i]);
    out.wheels.push_back(drive.wheels[i]);
    out.truth.push_back(drive.truth[i]);
    out.imu.back().utime += later;
    out.wheels.back().utime += later;
    out.truth.back().utime += later;
    for (std::size_t wheel = 0; wheel < 2; ++wheel) out.wheels.back().angle[wheel] += turned[wheel];
  };
  for (std::size_t i = 0; i < drive.imu.size(); ++i) {
    append(i);
    if (i != kAt) continue;
    for (std::size_t k = 0; k < kWheelsTurn; ++k) {
      if (k % kSpan == 0) later += 10'000 * static_cast<std::int64_t>(kSpan);
      const double gentle = std::min({1.0, static_cast<double>(k) / 50, static_cast<double>(kWheelsTurn - k) / 50});
      for (std::size_t wheel = 0; wheel < 2; ++wheel) turned[wheel] += 0.01 * gentle * speed[wheel];
      append(kAt - kSpan + 1 + k % kSpan);
    }
  }
  return out;
}

}  // namespace

const std::vector<HarmlessDrive>& harmless_drives() {
  static const std::vector<HarmlessDrive> drives = [] {
    std::vector<HarmlessDrive> out;
    const auto add = [&](const std::string& name, const std::function<Drive()>& make, double spin_ends = -1.0) {
      out.push_back({name, make, spin_ends});
    };
    for (const double radius : {-0.1, -0.05, 0.05, 0.1}) {
      for (const double track : {-0.1, 0.0, 0.1}) {
        const int percent = static_cast<int>(std::lround(100 * radius));
        add("radius " + std::to_string(percent) + " %, track " +
                std::to_string(static_cast<int>(std::lround(100 * track))) + " %",
            [=] { return town([=](TownDriveOptions& o) { o.scale = radius, o.track = track; }); });
      }
    }
    for (const double track : {0.3, 0.6, 1.0})
      add("skid steer, " + std::to_string(track),
          [=] { return town([=](TownDriveOptions& o) { o.track = track; }, 2); });
    for (const double track : {0.0, 0.1, 0.6}) {
      add("turns on the spot, track " + std::to_string(track), [=] {
        DriveOptions o;
        o.stop_at = 20.0;
        o.spin = 1.5;
        o.spin_seconds = 20.0;
        o.wheel_scale[2] = track;
        return simulate_drive(o, VehicleConfig());
      });
      add("circles, track " + std::to_string(track), [=] {
        DriveOptions o;
        o.stop_at = 1e9;
        o.circle = 0.5;
        o.curves = 0.0;
        o.hills = 0.01;
        o.wheel_scale[2] = track;
        return simulate_drive(o, VehicleConfig());
      });
    }
    for (const unsigned number : {1U, 2U}) {
      const std::string where = " in town " + std::to_string(number);
      add("wheels stamped up to 20 ms late" + where, [=] {
        Drive drive = plain_town(number);
        make_late(drive.wheels, 0.02, number);
        return drive;
      });
      add("IMU stamped up to 20 ms late" + where, [=] {
        Drive drive = plain_town(number);
        make_late(drive.imu, 0.02, number);
        return drive;
      });
      add("both stamped up to 20 ms late" + where, [=] {
        Drive drive = plain_town(number);
        make_late(drive.imu, 0.02, number);
        make_late(drive.wheels, 0.02, number + 10);
        return drive;
      });
      add("both stamped up to 60 ms late" + where, [=] {
        Drive drive = plain_town(number);
        make_late(drive.imu, 0.06, number);
        make_late(drive.wheels, 0.06, number + 10);
        return drive;
      });
    }
    const double grip = kIce + kIceSeconds;
    add(
        "the left wheel spins on ice",
        [] {
          return on_ice({0.6, 0});
        },
        grip);
    add(
        "the right wheel spins fast on ice",
        [] {
          return on_ice({0, 2});
        },
        grip);
    add(
        "both wheels spin on ice",
        [] {
          return on_ice({0.5, 0.5});
        },
        grip);
    add(
        "both wheels spin unevenly on ice",
        [] {
          return on_ice({0.4, 1.5});
        },
        grip);
    add(
        "both wheels slide on ice",
        [] {
          return on_ice({-1, -1});
        },
        grip);
    add("on a jack, both wheels turn", [] { return on_a_jack({4, 4}); });
    add("on a jack, one wheel turns", [] { return on_a_jack({4, 0}); });
    add("on a jack, both turn backwards", [] { return on_a_jack({-4, -4}); });
    return out;
  }();
  return drives;
}

}  // namespace curbstone::ekf
