// curbstone-encoder: a CANopen wheel drive, by SLCAN or SocketCAN -> WHEELS.
#include "common/shell/service.hpp"
#include "config/sections.hpp"
#include "drivers/encoder/can/slcan_link.hpp"
#include "drivers/encoder/can/socketcan_link.hpp"
#include "drivers/encoder/encoder_node.hpp"

namespace {

using namespace curbstone;

std::unique_ptr<encoder::can::CanLink> open_link(const encoder::EncoderConfig& config) {
  if (config.interface == encoder::CanInterface::kSocketCan) {
    return std::make_unique<encoder::can::SocketCanLink>(
        config.device, encoder::canopen::WheelDrive::ids(static_cast<std::uint8_t>(config.node)));
  }
  return std::make_unique<encoder::can::SlcanLink>(serial::SerialSettings{config.device, config.baud}, config.bitrate);
}

}  // namespace

int main(int argc, char** argv) {
  std::unique_ptr<encoder::can::CanLink> link;  // outlives the loop that calls it
  return run_service<encoder::EncoderConfig>(
      argc, argv, {"encoder", kProcessSections, "CANopen wheel drive (ZLAC8015D), by SLCAN or SocketCAN -> WHEELS"},
      [&](const encoder::EncoderConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        link = open_link(config);
        auto node = std::make_unique<encoder::EncoderNode>(
            config, context.bus, [&link](const encoder::can::CanFrame& frame) { link->send(frame); });
        node->add_report([&link](NodeReport& report) { link->report(report); });
        link->attach(context.loop,
                     {[node = node.get()](auto utime, const auto& frame) { node->on_frame(utime, frame); },
                      [node = node.get()](auto now, bool up, const auto& why) { node->on_link(now, up, why); }});
        return node;
      });
}
