#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace curbstone::simulate::devices {

/// What one laser got back.
struct LidarShot {
  float range_m = 0;  ///< from the lens along the beam; <= 0 or more than the device can say is no return
  std::uint8_t intensity = 0;
};

/// Where and when one laser of a firing really looks: a target at range r is at `origin + r * direction`.
struct LidarRay {
  double time_offset = 0;  ///< s after the firing's first shot
  Eigen::Vector3d origin;  ///< m in the lidar frame (x forward, y left, z up)
  Eigen::Vector3d direction;
};

/// Which echo of a shot a device reports.
enum class ReturnMode { kStrongest, kLast, kDual };

/// The facts of a device. A firing is one pass over its lasers, in which each fires once.
struct LidarTable {
  std::string_view name;  ///< as the driver's configuration has it: "rs16"
  int lasers = 0;
  double firing_period = 0;  ///< s, from one firing to the next
  int firings_per_packet = 0;
  std::size_t packet_size = 0;  ///< bytes of UDP payload, of a point packet
  double lens_offset = 0;       ///< m, of the lens from the axis, in the direction of the beam
  int point_port = 0;           ///< UDP, as delivered
  int info_port = 0;
  std::int64_t info_period = 0;  ///< us, from one packet of device information to the next

  [[nodiscard]] double packet_period() const { return firings_per_packet * firing_period; }
};

/// Builds the packets of a LiDAR from what its lasers measured. Pure: whoever simulates casts the rays, keeps the time
/// and sends the packets.
///
/// The firings come every `firing_period`; the head turns azimuth_step() meanwhile. A packet carries the time of its
/// first shot and few azimuths (0.01 deg): a decoder interpolates the rest, which is exact while the firings keep that
/// pace. Azimuths are in deg, clockwise from above, 0 is x. Times are us since the Unix epoch.
class LidarEmulator {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Shots = std::span<const LidarShot>;  ///< one a laser, in firing order

  virtual ~LidarEmulator() = default;

  [[nodiscard]] virtual const LidarTable& table() const = 0;
  /// deg above the horizon, by laser.
  [[nodiscard]] virtual std::vector<double> elevations_deg() const = 0;
  /// deg that the head turns from one firing to the next.
  [[nodiscard]] virtual double azimuth_step() const = 0;

  /// Beams of the firing that starts at this azimuth, by laser.
  virtual void beams(double azimuth_deg, std::span<LidarRay> by_laser) const = 0;

  /// Adds the firing whose first shot is at `utime`. A packet comes out with the last one of a packet. A device that
  /// reports one echo takes it from `strongest` or `last`, by its return mode.
  virtual std::optional<Bytes> add_firing(std::int64_t utime, double azimuth_deg, Shots strongest, Shots last) = 0;
  /// The same of shots with one echo each.
  std::optional<Bytes> add_firing(std::int64_t utime, double azimuth_deg, Shots shots) {
    return add_firing(utime, azimuth_deg, shots, shots);
  }

  /// Sets the stamp of a point packet anew.
  virtual void set_time(std::span<std::uint8_t> packet, std::int64_t utime) const = 0;

  /// What the device says of itself.
  [[nodiscard]] virtual Bytes info(std::int64_t utime) const = 0;
};

}  // namespace curbstone::simulate::devices
