#pragma once

#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/bus/local_bus.hpp"
#include "drivers/lidar/lidar_node.hpp"
#include "drivers/lidar/models/make_model.hpp"
#include "tools/lidar_tool/packets.hpp"

namespace curbstone::lidar_tool {

/// One device's packets through the driver's own node, and what they tell of the device. One thread.
class Sensor {
 public:
  using OnPoints = std::function<void(const lidar_points_t&)>;

  explicit Sensor(lidar::models::ModelName model, const OnPoints& on_points = {});

  /// What the device says of itself, ahead of its points: so a capture's first points have the device's own angles.
  void prepare(const Packet& packet);
  void on_packet(const Packet& packet);
  /// Nothing more comes.
  void finish();

  [[nodiscard]] const lidar::models::ModelTable& table() const { return model_->table(); }
  [[nodiscard]] const lidar::models::DeviceFacts& facts() const { return model_->facts(); }
  [[nodiscard]] Counters counters() const { return node_.report().counters; }
  /// All "refused.*" together.
  [[nodiscard]] std::int64_t refused() const;
  /// "strongest", "last", "dual", "first"; empty until the device has sent it.
  [[nodiscard]] const std::string& return_mode() const { return return_mode_; }
  /// rpm, by the azimuths of the last packets; 0 until known.
  [[nodiscard]] double rpm() const { return rpm_; }
  /// The device's stamps minus the times of receipt, us: of the packet that was least late.
  [[nodiscard]] std::optional<std::int64_t> clock_difference() const { return clock_difference_; }
  [[nodiscard]] std::optional<std::int64_t> last_stamp() const { return last_stamp_; }

 private:
  LocalBus bus_;
  lidar::LidarNode node_;
  std::unique_ptr<lidar::models::Model> model_;  ///< beside the node's own: for what that does not tell
  lidar::decoding::DecodedPacket decoded_;
  std::string return_mode_;
  double rpm_ = 0;
  std::optional<std::int64_t> clock_difference_;
  std::optional<std::int64_t> last_stamp_;
};

}  // namespace curbstone::lidar_tool
