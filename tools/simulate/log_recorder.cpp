#include "tools/simulate/log_recorder.hpp"

#include <cmath>
#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <limits>
#include <numbers>

#include "tools/simulate/sensors/lidar_model.hpp"

namespace curbstone {

namespace {

/// Every message goes into the log at the time at which the driver would have sent it.
class LogPublisher final : public Publisher {
 public:
  explicit LogPublisher(const std::string& file) : log_(file) {}
  void set_now(std::int64_t now) { now_ = now; }
  [[nodiscard]] std::int64_t count() const { return count_; }

 protected:
  void publish_bytes(const std::string& channel, const void* data, int size) override {
    log_.write(channel, data, size, now_);
    ++count_;
  }

 private:
  LogWriter log_;
  std::int64_t now_ = 0;
  std::int64_t count_ = 0;
};

// Stopgap until the drivers' nodes are on main.
lidar_points_t decode(const Rs16Packet& bytes, std::int64_t utime, int number, int& revolution, int& last_azimuth,
                      double rpm) {
  const ElevationTable elevations = Rs16EmulatorConfig().elevations;
  lidar_points_t m;
  m.utime = utime;
  m.packet = number;
  const double rate = rpm / 60.0 * 360.0;
  for (int block = 0; block < kBlocksPerPacket; ++block) {
    const std::uint8_t* b = bytes.data() + 42 + 100 * block;
    const int azimuth = b[2] * 256 + b[3];
    if (block == 0) {
      if (last_azimuth < 18000 && azimuth >= 18000) ++revolution;
      last_azimuth = azimuth;
    }
    for (int c = 0; c < 32; ++c) {
      const int raw = b[4 + 3 * c] * 256 + b[5 + 3 * c];
      if (raw == 0) continue;
      const int laser = c % 16;
      const double t = (c / 16) * kSequencePeriod + laser * kLaserPeriod;
      const double a = (azimuth * 0.01 + rate * t) * std::numbers::pi / 180.0;
      const double e = elevations[static_cast<std::size_t>(laser)] * std::numbers::pi / 180.0;
      const double horizontal = raw * 0.005 * std::cos(e) + kLensOffset;
      m.x.push_back(static_cast<float>(horizontal * std::cos(a)));
      m.y.push_back(static_cast<float>(-horizontal * std::sin(a)));
      m.z.push_back(static_cast<float>(raw * 0.005 * std::sin(e)));
      m.time_offset.push_back(static_cast<float>(block * kBlockPeriod + t));
      m.intensity.push_back(b[6 + 3 * c]);
      m.ring.push_back(static_cast<std::uint8_t>(laser < 8 ? laser : 23 - laser));
    }
  }
  m.num_points = static_cast<std::int32_t>(m.x.size());
  return m;
}

}  // namespace

Recorded record_drive(const Drive& drive, const std::string& log_file) {
  LogPublisher log(log_file);
  const Random random(drive.seed);
  const VehicleConfig& vehicle = drive.config.vehicle;
  LidarModel lidar({drive.rpm, drive.seed, drive.start_utime}, vehicle, drive.motion, drive.surroundings);
  ImuModel imu(drive.config.imu, vehicle, drive.motion, random.fork(11));
  WheelModel wheels(drive.config.wheels, vehicle, drive.motion, drive.seconds, random.fork(12));
  const auto utime = [&](double t) { return drive.start_utime + std::llround(t * 1e6); };

  Recorded recorded;
  int revolution = 0, last_azimuth = 0;
  std::array<std::int64_t, 2> last_counts{};
  LidarModel::Packet packet = lidar.next();
  double next_imu = 0.0013, next_wheels = 0.0047;
  for (;;) {
    const double t = std::min({packet.t_last, next_imu, next_wheels});
    if (t > drive.seconds) break;
    if (t == packet.t_last) {
      log.set_now(utime(t) + 150);
      log.publish("LIDAR_POINTS", decode(packet.bytes, utime(packet.t), static_cast<int>(recorded.packets), revolution,
                                         last_azimuth, drive.rpm));
      ++recorded.packets;
      packet = lidar.next();
    } else if (t == next_imu) {
      const Inertia inertia = imu.sample(t);
      imu_t m{};
      m.utime = utime(t);
      m.sequence = static_cast<std::int32_t>(recorded.imu++);
      for (int i = 0; i < 3; ++i) {
        m.acceleration[i] = static_cast<double>(static_cast<float>(inertia.specific_force[i]));
        m.angular_rate[i] = static_cast<double>(static_cast<float>(inertia.angular_rate[i]));
      }
      m.temperature = std::numeric_limits<float>::quiet_NaN();
      log.set_now(m.utime + 1200);
      log.publish("IMU", m);
      next_imu += 0.01;
    } else {
      const auto counts = wheels.counts(t);
      wheels_t m{};
      m.utime = utime(t);
      m.sequence = static_cast<std::int32_t>(recorded.wheels++);
      for (std::size_t i = 0; i < 2; ++i) {
        const double per_count = 2.0 * std::numbers::pi / drive.config.wheels.counts_per_revolution;
        m.counts[i] = counts[i];
        m.angle[i] = static_cast<double>(counts[i]) * per_count;
        m.speed[i] = recorded.wheels == 1 ? 0.0 : static_cast<double>(counts[i] - last_counts[i]) * per_count / 0.01;
      }
      last_counts = counts;
      m.enabled = true;
      log.set_now(m.utime + 900);
      log.publish("WHEELS", m);
      next_wheels += 0.01;
    }
  }
  recorded.messages = log.count();
  return recorded;
}

}  // namespace curbstone
