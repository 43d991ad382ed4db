#include "tools/simulate/sensors/lidar_model.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "tools/simulate/numerics/random.hpp"

namespace curbstone::simulate::sensors {

LidarModel::LidarModel(const Options& options, const VehicleConfig& vehicle, const motion::Motion& motion,
                       Surroundings& surroundings)
    : options_(options),
      T_base_lidar_(vehicle.T_base_lidar()),
      motion_(motion),
      surroundings_(surroundings),
      device_(devices::make_lidar(options.lidar, options.rpm)),
      rays_(static_cast<std::size_t>(device_->table().lasers)),
      shots_(rays_.size()) {}

LidarModel::Packet LidarModel::next() {
  const devices::LidarTable& table = device_->table();
  const double period = table.packet_period();
  Packet packet;
  packet.t = static_cast<double>(firing_) * table.firing_period;
  // Within a millisecond the vehicle's motion is linear with a constant angular rate.
  const Pose T_first = motion_.T_world_base(packet.t) * T_base_lidar_;
  const Pose T_last = motion_.T_world_base(packet.t + period) * T_base_lidar_;
  const Eigen::Vector3d velocity = (T_last.translation() - T_first.translation()) / period;
  const auto azimuth_of = [&](std::int64_t firing) {
    const double turns = (options_.azimuth + static_cast<double>(firing) * device_->azimuth_step()) / 360.0;
    return 360.0 * (turns - std::floor(turns));
  };
  constexpr double kDegree = std::numbers::pi / 180.0;
  surroundings_.prepare({packet.t + 0.5 * period, interpolate(T_first, T_last, 0.5), kDegree * azimuth_of(firing_),
                         kDegree * device_->azimuth_step() * table.firings_per_packet});

  for (int k = 0; k < table.firings_per_packet; ++k, ++firing_) {
    const double t = static_cast<double>(firing_) * table.firing_period;
    const double azimuth = azimuth_of(firing_);
    const Pose T = interpolate(T_first, T_last, (t - packet.t) / period);
    device_->beams(azimuth, rays_);
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const devices::LidarRay& ray = rays_[i];
      Shot shot;
      shot.t = t + ray.time_offset;
      shot.laser = static_cast<int>(i);
      shot.azimuth = std::atan2(-ray.direction.y(), ray.direction.x());
      shot.origin_world = T * ray.origin + ray.time_offset * velocity;
      shot.direction_world = T.linear() * ray.direction;
      shot.noise = numerics::mix_bits(
          options_.seed ^ numerics::mix_bits(static_cast<std::uint64_t>(firing_ * table.lasers + static_cast<int>(i))));
      shots_[i] = surroundings_.measure(shot);
    }
    const std::int64_t utime = options_.start_utime + std::llround(t * 1e6);
    if (auto bytes = device_->add_firing(utime, azimuth, shots_)) packet.bytes = std::move(*bytes);
  }
  packet.t_last = packet.t + period - table.firing_period + rays_.back().time_offset;
  return packet;
}

std::vector<std::uint8_t> LidarModel::info(double t) const {
  return device_->info(options_.start_utime + std::llround(t * 1e6));
}

}  // namespace curbstone::simulate::sensors
