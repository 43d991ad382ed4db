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
#include "drivers/lidar/models/base/sender.hpp"

namespace curbstone::lidar::models {

/// The facts of a model.
struct ModelTable {
  std::string_view name;   ///< as the configuration has it: "rs16"
  std::string_view title;  ///< "RoboSense RS-LiDAR-16"
  int point_port = 0;      ///< UDP, as delivered
  int info_port = 0;
  int lasers = 0;
  bool needs_info = true;          ///< its silence about itself is a fault
  bool has_nominal_angles = true;  ///< to be used until its own are known
};

enum class PacketKind {
  kForeign,  ///< of another device
  kPoints,
  kInfo,  ///< what the device says of itself
};

/// Where a laser looks.
struct LaserAngles {
  double elevation = 0;  ///< deg above the horizon
  double azimuth = 0;    ///< deg beside the head's azimuth, clockwise

  bool operator==(const LaserAngles&) const = default;
};

/// What the user decides, for all models.
struct ModelSettings {
  decoding::ReturnLimits limits;
  std::optional<double> distance_step;  ///< m; nothing: the device's own
  std::vector<LaserAngles> angles;      ///< from a file, by laser in firing order; empty: the device's own
  bool wait_for_info = false;           ///< no points before the device has reported its angles
  bool only_info = false;               ///< but one device information will come: it counts if it is plausible
};

/// What a device says of itself, as far as the driver has it.
struct DeviceFacts {
  bool reported = false;            ///< the device has said something, twice the same
  double field_of_view = 360;       ///< deg that it fires in
  bool angles_known = false;        ///< of this very device: by itself or from a file. Else nominal, or no points
  Counters values;                  ///< for SERVICE_STATUS: "device.rpm"
  std::vector<std::string> faults;  ///< what the device says is wrong, in words
  std::string identity;             ///< "serial number 33C1160BAAA, firmware ..."; empty where it reports none
};

/// One model of LiDAR: its packets to points. What it gives is a function of the packets and their times of receipt.
/// One thread. Any bytes may come; bad ones are refused with their cause.
class Model {
 public:
  virtual ~Model() = default;

  [[nodiscard]] virtual const ModelTable& table() const = 0;

  /// Whether a packet of this sender is one of this model's, for certain.
  [[nodiscard]] bool is_own(Sender sender) const {
    return sender != Sender::kUnknown && kind_of(sender) != PacketKind::kForeign;
  }

  /// What a packet of this sender is to the model. Unknown ones are to be taken for points, for decode() tells what is
  /// wrong with them.
  [[nodiscard]] virtual PacketKind kind_of(Sender sender) const = 0;

  /// A point packet. Overwrites `packet`, whose vectors keep their memory; it means nothing when refused, but for
  /// `stamp` and `gap`. `received`: us since the Unix epoch, for devices that do not tell the date.
  [[nodiscard]] virtual decoding::Refusal decode(std::int64_t received, std::span<const std::uint8_t> bytes,
                                                 decoding::DecodedPacket& packet) = 0;

  /// Device information. It takes effect once two packets in a row agree.
  [[nodiscard]] virtual decoding::Refusal read_info(std::int64_t received, std::span<const std::uint8_t> bytes) = 0;

  [[nodiscard]] virtual const DeviceFacts& facts() const = 0;
};

}  // namespace curbstone::lidar::models
