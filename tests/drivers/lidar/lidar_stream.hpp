#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "tests/drivers/lidar/bench.hpp"
#include "tools/simulate/devices/lidar_emulator.hpp"

namespace curbstone::lidar {

/// The packets of an emulated device whose head turns as a test says, and where each return really was. The scene is a
/// wall around the device whose distance differs from azimuth to azimuth: a point of a wrong azimuth is a wrong point.
class LidarStream {
 public:
  static constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us
  using Device = simulate::devices::LidarEmulator;

  /// `rpm` at a time, us after the start: 0 is a head that stands.
  explicit LidarStream(std::unique_ptr<Device> device, std::function<double(std::int64_t)> rpm = {})
      : device_(std::move(device)), rpm_(std::move(rpm)) {}

  /// Puts another device in this one's place: the same one, set otherwise.
  void become(std::unique_ptr<Device> device) { device_ = std::move(device); }
  [[nodiscard]] const Device& device() const { return *device_; }

  /// The packets of the next `us`.
  void run_for(std::int64_t us, std::vector<RecordedPacket>& packets) {
    const auto lasers = static_cast<std::size_t>(device_->table().lasers);
    std::vector<simulate::devices::LidarShot> strongest(lasers), last(lasers);
    for (const double end = time_ + static_cast<double>(us); time_ < end;) {
      if (time_ >= next_info_) {
        packets.push_back({at(time_), device_->table().info_port, device_->info(at(time_))});
        next_info_ = time_ + static_cast<double>(device_->table().info_period);
      }
      for (std::size_t laser = 0; laser < lasers; ++laser) {
        const bool blind = std::ranges::find(dead_, laser) != dead_.end();
        strongest[laser] = {blind ? 0.0F : static_cast<float>(range(azimuth_)), 100};
        last[laser] = strongest[laser];
      }
      firings_.push_back({at(time_), azimuth_});
      const auto packet = device_->add_firing(at(time_), std::fmod(azimuth_, 360.0), strongest, last);
      const double period = device_->table().firing_period * 1e6;
      const double step = rpm_ ? rpm_(static_cast<std::int64_t>(time_)) * 6e-6 * period : device_->azimuth_step();
      azimuth_ += step;
      time_ += period;
      if (packet) packets.push_back({at(time_) + kDelay, device_->table().point_port, *packet});
    }
  }
  /// Lasers whose shots bring nothing back from now on.
  void kill(std::vector<std::size_t> lasers) { dead_ = std::move(lasers); }

  /// Each point is where its laser hit the wall at its time; stamps increase.
  void expect_true(const std::vector<lidar_points_t>& messages, double tolerance = 0.03) const {
    std::int64_t before = 0;
    for (const lidar_points_t& m : messages) {
      ASSERT_GT(m.utime, before);
      before = m.utime;
      for (std::size_t i = 0; i < m.x.size(); i += 61) {
        ASSERT_LT(error(m, i), tolerance) << "point " << i << " of packet " << m.packet << ", "
                                          << static_cast<double>(m.utime - kStart) * 1e-6 << " s";
      }
    }
  }

  [[nodiscard]] bool is_true(const lidar_points_t& m, double tolerance = 0.03) const {
    for (std::size_t i = 0; i < m.x.size(); i += 61) {
      if (error(m, i) >= tolerance) return false;
    }
    return true;
  }

 private:
  static constexpr std::int64_t kDelay = 150;  // us, from the last shot to receipt
  struct Firing {
    std::int64_t utime;
    double azimuth;  // deg
  };
  static std::int64_t at(double time) { return kStart + std::llround(time); }
  static double range(double azimuth) { return 12 + 4 * std::sin(2 * azimuth * M_PI / 180); }

  /// m, from the point to where it should be.
  [[nodiscard]] double error(const lidar_points_t& m, std::size_t i) const {
    const double time = static_cast<double>(m.utime) + static_cast<double>(m.time_offset[i]) * 1e6;
    const auto firing = std::upper_bound(firings_.begin(), firings_.end(), time + 1.0,
                                         [](double t, const Firing& f) { return t < static_cast<double>(f.utime); });
    if (firing == firings_.begin()) return 1e9;
    const double azimuth = std::prev(firing)->azimuth;
    std::vector<simulate::devices::LidarRay> rays(static_cast<std::size_t>(device_->table().lasers));
    device_->beams(azimuth, rays);
    const std::vector<double> elevations = device_->elevations_deg();
    double least = 1e9;
    for (std::size_t laser = 0; laser < rays.size(); ++laser) {
      const auto lower = std::ranges::count_if(elevations, [&](double e) { return e < elevations[laser]; });
      if (lower != m.ring[i]) continue;
      const Eigen::Vector3d point(static_cast<double>(m.x[i]), static_cast<double>(m.y[i]),
                                  static_cast<double>(m.z[i]));
      least = std::min(least, (rays[laser].origin + range(azimuth) * rays[laser].direction - point).norm());
    }
    return least;
  }

  std::unique_ptr<Device> device_;
  std::function<double(std::int64_t)> rpm_;
  std::vector<std::size_t> dead_;
  std::vector<Firing> firings_;
  double time_ = 0;       // us after the start
  double next_info_ = 0;  // us
  double azimuth_ = 0;    // deg, turned since the start
};

}  // namespace curbstone::lidar
