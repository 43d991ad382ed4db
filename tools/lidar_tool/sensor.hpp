#pragma once

#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "drivers/lidar/lidar_node.hpp"
#include "drivers/lidar/models/make_model.hpp"
#include "tools/lidar_tool/packets.hpp"

namespace curbstone::lidar_tool {

/// Runs one device's packets through the driver's own node, and collects what they tell about the device. One thread.
class Sensor {
 public:
  using OnPoints = std::function<void(const lidar_points_t&)>;

  explicit Sensor(lidar::models::ModelName model, const OnPoints& on_points = {});

  /// Takes device information ahead of the points, so that a capture's first points already use the device's own
  /// angles.
  void prepare(const Packet& packet);
  /// All of it was prepared: if there was only one, it counts.
  void finish_preparing();
  void on_packet(const Packet& packet);
  /// Ends the input.
  void finish();

  [[nodiscard]] const lidar::models::ModelTable& table() const { return model_->table(); }
  [[nodiscard]] const lidar::models::DeviceFacts& facts() const { return model_->facts(); }
  [[nodiscard]] Counters counters() const { return node_.report().counters; }
  /// Sum of all "refused.*" counters.
  [[nodiscard]] std::int64_t refused() const;
  /// "strongest", "last", "dual", "first"; empty until the device has sent it.
  [[nodiscard]] const std::string& return_mode() const { return return_mode_; }
  /// rpm, by the azimuths of the last packets; 0 while unknown.
  [[nodiscard]] double rpm() const { return rpm_; }
  /// The device's stamps minus the times of reception, us, of the packet with the smallest delay.
  [[nodiscard]] std::optional<std::int64_t> clock_difference() const { return clock_difference_; }
  [[nodiscard]] std::optional<std::int64_t> last_stamp() const { return last_stamp_; }

 private:
  struct Info {
    std::int64_t received;
    int port;
    std::vector<std::uint8_t> bytes;
  };
  void take_info(std::int64_t received, int port, std::span<const std::uint8_t> bytes);

  LocalBus bus_;
  lidar::LidarNode node_;
  std::unique_ptr<lidar::models::Model> model_;  ///< a second one, for data that the node does not expose
  lidar::decoding::DecodedPacket decoded_;
  int prepared_ = 0;
  std::optional<Info> only_info_;
  std::string return_mode_;
  double rpm_ = 0;
  std::optional<std::int64_t> clock_difference_;
  std::optional<std::int64_t> last_stamp_;
};

}  // namespace curbstone::lidar_tool
