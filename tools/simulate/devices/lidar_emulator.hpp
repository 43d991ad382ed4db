#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace curbstone::simulate::devices {

/// The return of one laser.
struct LidarShot {
  float range_m = 0;  ///< from the lens along the beam; <= 0 or beyond the device's range: no return
  std::uint8_t intensity = 0;
};

/// The beam and time of one laser in a firing: a target at range r is at `origin + r * direction`.
struct LidarRay {
  double time_offset = 0;  ///< s after the firing's first shot
  Eigen::Vector3d origin;  ///< m in the lidar frame (x forward, y left, z up)
  Eigen::Vector3d direction;
};

/// The echo of a shot that a device reports.
enum class ReturnMode { kStrongest, kLast, kDual };

/// The parameters of a device. A firing is one pass over its lasers, in which each fires once.
struct LidarTable {
  std::string_view name;  ///< as in the driver's configuration: "rs16"
  int lasers = 0;
  double firing_period = 0;  ///< s, from one firing to the next
  int firings_per_packet = 0;
  std::size_t packet_size = 0;  ///< bytes of UDP payload, of a point packet
  double lens_offset = 0;       ///< m, of the lens from the axis, in the direction of the beam
  int point_port = 0;           ///< UDP, factory default
  int info_port = 0;
  std::int64_t info_period = 0;  ///< us, from one packet of device information to the next

  [[nodiscard]] double packet_period() const { return firings_per_packet * firing_period; }
};

/// Builds the packets of a LiDAR from the returns of its lasers. Pure: the simulator casts the rays, keeps the time and
/// sends the packets.
///
/// The interval between firings is `firing_period`; the head turns by azimuth_step() meanwhile. A packet has the time
/// of its first shot and few azimuths (0.01 deg): a decoder interpolates the rest, which is exact while the firings
/// keep that interval. Azimuths are in deg, clockwise from above, 0 is x. Times are us since the Unix epoch.
class LidarEmulator {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Shots = std::span<const LidarShot>;  ///< one per laser, in firing order

  virtual ~LidarEmulator() = default;

  [[nodiscard]] virtual const LidarTable& table() const = 0;
  /// deg above the horizon, by laser.
  [[nodiscard]] virtual std::vector<double> elevations_deg() const = 0;
  /// deg the head turns from one firing to the next.
  [[nodiscard]] virtual double azimuth_step() const = 0;

  /// Beams of the firing that starts at this azimuth, by laser.
  virtual void beams(double azimuth_deg, std::span<LidarRay> by_laser) const = 0;

  /// Adds the firing whose first shot is at `utime`. Returns a packet with the last firing of each packet. A device
  /// that reports one echo takes it from `strongest` or `last`, by its return mode.
  virtual std::optional<Bytes> add_firing(std::int64_t utime, double azimuth_deg, Shots strongest, Shots last) = 0;
  /// The same for shots with one echo each.
  std::optional<Bytes> add_firing(std::int64_t utime, double azimuth_deg, Shots shots) {
    return add_firing(utime, azimuth_deg, shots, shots);
  }

  /// Replaces the stamp of a point packet.
  virtual void set_time(std::span<std::uint8_t> packet, std::int64_t utime) const = 0;

  /// The device information packet.
  [[nodiscard]] virtual Bytes info(std::int64_t utime) const = 0;
};

}  // namespace curbstone::simulate::devices
