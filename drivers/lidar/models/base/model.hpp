#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/counters.hpp"
#include "drivers/lidar/decoding/decoded_packet.hpp"
#include "drivers/lidar/decoding/point_writer.hpp"
#include "drivers/lidar/decoding/refusal.hpp"
#include "drivers/lidar/models/base/identity.hpp"
#include "drivers/lidar/models/base/sender.hpp"

namespace curbstone::lidar::models {

/// Constants of a model.
struct ModelTable {
  std::string_view name;   ///< name in the configuration: "rs16"
  std::string_view title;  ///< "RoboSense RS-LiDAR-16"
  int point_port = 0;      ///< UDP, factory setting
  int info_port = 0;
  int lasers = 0;
  bool needs_info = true;          ///< missing device information is a fault
  bool has_nominal_angles = true;  ///< used until the device's own are known
};

enum class PacketKind {
  kForeign,  ///< from another device
  kPoints,
  kInfo,  ///< device information
};

/// Direction of a laser.
struct LaserAngles {
  double elevation = 0;  ///< deg above the horizon
  double azimuth = 0;    ///< deg relative to the head's azimuth, clockwise

  bool operator==(const LaserAngles&) const = default;
};

/// The user's settings, for all models.
struct ModelSettings {
  decoding::ReturnLimits limits;
  std::optional<double> distance_step;  ///< m; nothing: the device's own
  std::vector<LaserAngles> angles;      ///< from a file, by laser in firing order; empty: the device's own
  bool wait_for_info = false;           ///< no points before the device has reported its angles
  bool only_info = false;               ///< only one device information will come: it counts if it is plausible
};

/// The latest device information.
struct DeviceFacts {
  bool reported = false;            ///< the device has reported twice the same
  double field_of_view = 360;       ///< deg in which it fires
  bool angles_known = false;        ///< of this device: reported or from a file. Otherwise nominal, or no points
  Counters values;                  ///< for SERVICE_STATUS: "device.rpm"
  std::vector<std::string> faults;  ///< faults that the device reports, in words
  Identity identity;                ///< reported twice the same
};

/// Interface of a LiDAR model: converts its packets to points. The output is a function of the packets and their times
/// of receipt. One thread. Any bytes are allowed; invalid ones are refused with their cause.
class Model {
 public:
  virtual ~Model() = default;

  [[nodiscard]] virtual const ModelTable& table() const = 0;

  /// Whether a packet of this sender certainly belongs to this model.
  [[nodiscard]] bool is_own(Sender sender) const {
    return sender != Sender::kUnknown && kind_of(sender) != PacketKind::kForeign;
  }

  /// Kind of a packet of this sender for the model. Unknown ones count as points, because decode() reports what is
  /// wrong with them.
  [[nodiscard]] virtual PacketKind kind_of(Sender sender) const = 0;

  /// Decodes a point packet. Overwrites `packet`, whose vectors keep their memory; if refused it is undefined, except
  /// for `stamp` and `gap`. `received`: us since the Unix epoch, for devices that do not send the date.
  [[nodiscard]] virtual decoding::Refusal decode(std::int64_t received, std::span<const std::uint8_t> bytes,
                                                 decoding::DecodedPacket& packet) = 0;

  /// Reads device information. It takes effect when two consecutive packets agree.
  [[nodiscard]] virtual decoding::Refusal read_info(std::int64_t received, std::span<const std::uint8_t> bytes) = 0;

  [[nodiscard]] virtual const DeviceFacts& facts() const = 0;
};

}  // namespace curbstone::lidar::models
