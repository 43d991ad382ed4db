#include "tools/lidar_tool/devices.hpp"

#include <algorithm>
#include <functional>
#include <tuple>
#include <utility>

#include "drivers/lidar/models/model_vote.hpp"

namespace curbstone::lidar_tool {

using lidar::models::ModelName;
using lidar::models::Sender;

double Stream::rate() const {
  return packets > 1 && last > first ? static_cast<double>(packets - 1) / seconds() : 0.0;
}

std::int64_t Device::packets() const {
  std::int64_t sum = 0;
  for (const Stream& stream : streams) sum += stream.packets;
  return sum;
}

std::optional<ModelName> model_named(const std::string& name) {
  constexpr std::pair<const char*, ModelName> kNames[] = {{"rs16", ModelName::kRs16},
                                                          {"helios16p", ModelName::kHelios16p},
                                                          {"helios32", ModelName::kHelios32},
                                                          {"vlp16", ModelName::kVlp16}};
  const auto tables = lidar::models::tables();
  if (std::ranges::none_of(tables, [&](const auto* table) { return table->name == name; })) return std::nullopt;
  for (const auto& [text, model] : kNames) {
    if (name == text) return model;
  }
  return std::nullopt;
}

std::optional<ModelName> model_of(Sender kind) {
  switch (kind) {
    case Sender::kRs16:
      return model_named("rs16");
    case Sender::kHelios:
    case Sender::kHelios16p:
      return model_named("helios16p");
    case Sender::kHelios32:
      return model_named("helios32");
    case Sender::kVlp16:
      return model_named("vlp16");
    default:
      return std::nullopt;
  }
}

namespace {

/// Of a Helios whose packets do not state the number of lasers: by its device information, as the driver decides it.
std::optional<ModelName> helios_of(const Packets& packets, const Device& device) {
  lidar::models::ModelVote vote;
  std::int64_t infos = 0;
  for (const Stream& stream : device.streams) infos += stream.kind == Sender::kHeliosInfo ? stream.packets : 0;
  if (infos == 1) vote.expect_one_info();
  std::optional<ModelName> model;
  packets.for_each([&](const Packet& packet) {
    if (packet.sender == device.address && !model) model = vote.offer(packet.bytes);
  });
  return model;
}

}  // namespace

std::vector<Device> devices_in(const Packets& packets) {
  std::map<std::tuple<lidar::sources::Ipv4, int, Sender>, Stream> streams;
  packets.for_each([&](const Packet& packet) {
    const Sender kind = lidar::models::sender_of(packet.bytes);
    Stream& stream = streams[{packet.sender, packet.port, kind}];
    if (stream.packets++ == 0)
      stream = {packet.port, kind, 1, packet.bytes.size(), packet.bytes.size(), packet.received, packet.received};
    stream.shortest = std::min(stream.shortest, packet.bytes.size());
    stream.longest = std::max(stream.longest, packet.bytes.size());
    stream.first = std::min(stream.first, packet.received);
    stream.last = std::max(stream.last, packet.received);
  });
  std::vector<Device> devices;
  for (const auto& [key, stream] : streams) {
    const auto address = std::get<0>(key);
    if (devices.empty() || devices.back().address != address) devices.push_back({address, {}, {}});
    devices.back().streams.push_back(stream);
  }
  for (Device& device : devices) {
    std::ranges::stable_sort(device.streams, std::greater{}, &Stream::packets);
    for (const Stream& stream : device.streams) {
      if (device.model) break;
      device.model = model_of(stream.kind);
      if (stream.kind == Sender::kHelios) device.model = helios_of(packets, device).value_or(*device.model);
    }
  }
  std::ranges::stable_sort(devices, std::greater{}, [](const Device& device) { return device.packets(); });
  return devices;
}

}  // namespace curbstone::lidar_tool
