// curbstone-imu: an Xsens MTi on a serial port -> IMU.
#include <optional>

#include "common/service.hpp"
#include "drivers/imu/imu_node.hpp"
#include "drivers/serial/serial_link.hpp"

int main(int argc, char** argv) {
  using namespace curbstone;
  std::optional<SerialLink> link;
  return run_service<ImuConfig>(
      argc, argv, "imu", "Xsens MTi (MTData2) on a serial port -> IMU",
      [&](const ImuConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        link.emplace(SerialSettings{config.device, config.baud});
        auto node = std::make_unique<ImuNode>(config, context.bus, [&](auto bytes) { link->send(bytes); });
        link->attach(context.loop,
                     {[node = node.get()](auto utime, auto bytes) { node->on_bytes(utime, bytes); },
                      [node = node.get()](auto now, bool up, const auto& why) { node->on_link(now, up, why); }});
        return node;
      });
}
