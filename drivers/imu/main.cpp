// curbstone-imu: an Xsens MTi or a WitMotion on a serial port -> IMU.
#include <optional>

#include "common/shell/service.hpp"
#include "config/sections.hpp"
#include "drivers/imu/imu_node.hpp"
#include "drivers/serial/serial_link.hpp"

int main(int argc, char** argv) {
  using namespace curbstone;
  std::optional<serial::SerialLink> link;
  return run_service<imu::ImuConfig>(
      argc, argv, {"imu", kProcessSections, "Xsens MTi or WitMotion on a serial port -> IMU"},
      [&](const imu::ImuConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        link.emplace(serial::SerialSettings{config.device, config.baud, config.low_latency});
        auto node = std::make_unique<imu::ImuNode>(config, context.bus, [&](auto bytes) { link->send(bytes); });
        node->add_report([&](NodeReport& report) { link->report(report); });
        link->attach(context.loop,
                     {[node = node.get()](auto utime, auto bytes) { node->on_bytes(utime, bytes); },
                      [node = node.get()](auto now, auto state, const auto& why) { node->on_link(now, state, why); }});
        return node;
      });
}
