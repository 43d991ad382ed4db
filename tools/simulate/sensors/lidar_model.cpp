#include "tools/simulate/sensors/lidar_model.hpp"

#include <cmath>
#include <numbers>

#include "tools/simulate/numerics/random.hpp"

namespace curbstone::simulate::sensors {

namespace {

devices::Rs16EmulatorConfig emulator_config(double rpm) {
  devices::Rs16EmulatorConfig config;
  config.rpm = rpm;
  return config;
}

}  // namespace

LidarModel::LidarModel(const Options& options, const VehicleConfig& vehicle, const motion::Motion& motion,
                       Surroundings& surroundings)
    : options_(options),
      T_base_lidar_(vehicle.T_base_lidar()),
      motion_(motion),
      surroundings_(surroundings),
      emulator_(emulator_config(options.rpm)) {}

LidarModel::Packet LidarModel::next() {
  Packet packet;
  packet.t = static_cast<double>(sequence_) * lidar::models::rs16::kSequencePeriod;
  packet.t_last = packet.t + lidar::models::rs16::kPacketPeriod - lidar::models::rs16::kSequencePeriod +
                  (lidar::models::rs16::kLasers - 1) * lidar::models::rs16::kLaserPeriod;
  // Within 1.3 ms a vehicle's motion is a straight line with a constant turn.
  const Pose T_first = motion_.T_world_base(packet.t) * T_base_lidar_;
  const Pose T_last = motion_.T_world_base(packet.t + lidar::models::rs16::kPacketPeriod) * T_base_lidar_;
  const Eigen::Vector3d velocity = (T_last.translation() - T_first.translation()) / lidar::models::rs16::kPacketPeriod;
  const auto azimuth_of = [&](std::int64_t sequence) {
    const double turns = (options_.azimuth + static_cast<double>(sequence) * emulator_.azimuth_step()) / 360.0;
    return 360.0 * (turns - std::floor(turns));
  };
  constexpr double kDegree = std::numbers::pi / 180.0;
  surroundings_.prepare({packet.t + 0.5 * lidar::models::rs16::kPacketPeriod, interpolate(T_first, T_last, 0.5),
                         kDegree * azimuth_of(sequence_),
                         kDegree * emulator_.azimuth_step() * lidar::models::rs16::kSequencesPerPacket});

  for (int k = 0; k < lidar::models::rs16::kSequencesPerPacket; ++k, ++sequence_) {
    const double t = static_cast<double>(sequence_) * lidar::models::rs16::kSequencePeriod;
    const double azimuth = azimuth_of(sequence_);
    const Pose T = interpolate(T_first, T_last, (t - packet.t) / lidar::models::rs16::kPacketPeriod);
    const auto rays = emulator_.rays(azimuth);
    std::array<devices::Rs16Shot, lidar::models::rs16::kLasers> shots;
    for (int i = 0; i < lidar::models::rs16::kLasers; ++i) {
      const devices::Rs16Ray& ray = rays[static_cast<std::size_t>(i)];
      Shot shot;
      shot.t = t + ray.time_offset;
      shot.laser = i;
      shot.azimuth = std::atan2(-ray.origin.y(), ray.origin.x());
      shot.origin_world = T * ray.origin + ray.time_offset * velocity;
      shot.direction_world = T.linear() * ray.direction;
      shot.noise = numerics::mix_bits(
          options_.seed ^ numerics::mix_bits(static_cast<std::uint64_t>(sequence_ * lidar::models::rs16::kLasers + i)));
      shots[static_cast<std::size_t>(i)] = surroundings_.measure(shot);
    }
    const std::int64_t utime = options_.start_utime + std::llround(t * 1e6);
    if (auto bytes = emulator_.add_sequence(utime, azimuth, shots)) packet.bytes = *bytes;
  }
  return packet;
}

lidar::models::rs16::Rs16Packet LidarModel::difop(double t) const {
  return emulator_.difop(options_.start_utime + std::llround(t * 1e6), static_cast<int>(std::lround(options_.rpm)));
}

}  // namespace curbstone::simulate::sensors
