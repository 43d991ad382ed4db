// curbstone-encoder: a wheel drive on CAN (SLCAN, SocketCAN, a recording) or Modbus (RS485, TCP) -> WHEELS.
#include <algorithm>
#include <iterator>
#include <vector>

#include "common/shell/service.hpp"
#include "common/time/clock.hpp"
#include "config/sections.hpp"
#include "drivers/encoder/can/slcan_link.hpp"
#include "drivers/encoder/can/socketcan_link.hpp"
#include "drivers/encoder/canopen/nodes_heard.hpp"
#include "drivers/encoder/encoder_node.hpp"
#include "drivers/encoder/modbus/modbus_link.hpp"
#include "drivers/encoder/modbus_node.hpp"
#include "drivers/encoder/traces/file_link.hpp"

namespace {

using namespace curbstone;
using encoder::EncoderConfig;
using encoder::Interface;
using encoder::canopen::NodesHeard;

/// The links outlive the loop that calls them.
struct Links {
  std::unique_ptr<encoder::can::CanLink> can;
  std::unique_ptr<encoder::modbus::ModbusLink> modbus;
};

std::unique_ptr<encoder::can::CanLink> open_can(const EncoderConfig& config) {
  if (config.interface == Interface::kSocketCan) {
    std::vector<std::uint32_t> ids = encoder::can_ids(config);
    if (config.signals.kind == encoder::SignalKind::kNone)
      std::ranges::copy(NodesHeard::ids(), std::back_inserter(ids));
    return std::make_unique<encoder::can::SocketCanLink>(config.device, ids);
  }
  if (config.interface == Interface::kFile)
    return std::make_unique<encoder::traces::FileLink>(config.file, config.file_rate, encoder::can_ids(config));
  return std::make_unique<encoder::can::SlcanLink>(serial::SerialSettings{config.device, config.baud}, config.bitrate);
}

std::unique_ptr<Node> can_node(const EncoderConfig& config, ServiceContext& context, Links& links) {
  links.can = open_can(config);
  auto* link = links.can.get();
  auto node = std::make_unique<encoder::EncoderNode>(
      config, context.bus, [link](const encoder::can::CanFrame& frame) { link->send(frame); });
  node->add_report([link](NodeReport& report) { link->report(report); });
  link->attach(context.loop,
               {[node = node.get()](auto utime, const auto& frame) { node->on_frame(utime, frame); },
                [node = node.get()](auto now, auto state, const auto& why) { node->on_link(now, state, why); },
                [node = node.get()](auto now, const char* cause) { node->on_refused(now, cause); }});
  return node;
}

std::unique_ptr<Node> modbus_node(const EncoderConfig& config, ServiceContext& context, Links& links) {
  links.modbus = std::make_unique<encoder::modbus::ModbusLink>(encoder::modbus_settings(config), config.modbus.rate);
  auto* link = links.modbus.get();
  auto node = std::make_unique<encoder::ModbusNode>(config, context.bus);
  node->add_report([link](NodeReport& report) { link->report(report); });
  link->attach(context.loop, {[node = node.get()](const auto& reading) { node->on_reading(wall_clock(), reading); },
                              [node = node.get()](auto state, const auto& why) { node->on_link(state, why); }});
  return node;
}

}  // namespace

int main(int argc, char** argv) {
  Links links;
  return run_service<EncoderConfig>(
      argc, argv,
      {"encoder", kProcessSections, "Wheel drive (ZLAC8015D) on CAN, by SLCAN or SocketCAN, or on Modbus -> WHEELS"},
      [&](const EncoderConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        const bool modbus = config.interface == Interface::kModbusRtu || config.interface == Interface::kModbusTcp;
        return modbus ? modbus_node(config, context, links) : can_node(config, context, links);
      });
}
