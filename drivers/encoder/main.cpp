// curbstone-encoder: a CANopen wheel drive, by SLCAN or SocketCAN -> WHEELS.
#include "common/service.hpp"
#include "drivers/encoder/encoder_node.hpp"
#include "drivers/encoder/slcan_link.hpp"
#include "drivers/encoder/socketcan_link.hpp"

namespace {

using namespace curbstone;

std::unique_ptr<CanLink> open_link(const EncoderConfig& config) {
  if (config.interface == "socketcan") {
    return std::make_unique<SocketCanLink>(config.device, WheelDrive::ids(static_cast<std::uint8_t>(config.node)));
  }
  return std::make_unique<SlcanLink>(SerialSettings{config.device, config.baud}, config.bitrate);
}

}  // namespace

int main(int argc, char** argv) {
  std::unique_ptr<CanLink> link;  // outlives the loop that calls it
  return run_service<EncoderConfig>(
      argc, argv, "encoder", "CANopen wheel drive (ZLAC8015D), by SLCAN or SocketCAN -> WHEELS",
      [&](const EncoderConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        link = open_link(config);
        auto node =
            std::make_unique<EncoderNode>(config, context.bus, [&link](const CanFrame& frame) { link->send(frame); });
        node->add_report([&link](NodeReport& report) { link->report(report); });
        link->attach(context.loop,
                     {[node = node.get()](auto utime, const auto& frame) { node->on_frame(utime, frame); },
                      [node = node.get()](auto now, bool up, const auto& why) { node->on_link(now, up, why); }});
        return node;
      });
}
