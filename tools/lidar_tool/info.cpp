#include "tools/lidar_tool/info.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cmath>
#include <ctime>

#include "tools/lidar_tool/devices.hpp"
#include "tools/lidar_tool/sensor.hpp"

namespace curbstone::lidar_tool {

using lidar::models::Sender;

namespace {

constexpr std::size_t kMaxDevices = 8;
constexpr std::size_t kMaxStreams = 8;

std::string line(const std::string& what, const std::string& text) {
  return fmt::format("  {:<9} {}\n", what, text);
}

std::string utc(std::int64_t utime) {
  const std::time_t seconds = utime / 1'000'000;
  std::tm parts{};
  if (gmtime_r(&seconds, &parts) == nullptr) return "?";
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", parts);
}

std::string kind_text(Sender kind) {
  switch (kind) {
    case Sender::kUnknown:
      return "of no LiDAR that is known";
    case Sender::kRs16Info:
    case Sender::kHeliosInfo:
      return "device information";
    case Sender::kVlp16Position:
      return "position";
    case Sender::kHesai:
    case Sender::kLivox:
    case Sender::kOuster:
      return "points, or other data of that maker";
    default:
      return "points";
  }
}

std::string stream_text(const Stream& stream) {
  const std::string length = stream.shortest == stream.longest
                                 ? fmt::format("{} bytes", stream.shortest)
                                 : fmt::format("{} to {} bytes", stream.shortest, stream.longest);
  return fmt::format("{}: {} packets of {}, {:.1f} s, {:.1f} a second ({})", stream.port, stream.packets, length,
                     stream.seconds(), stream.rate(), kind_text(stream.kind));
}

/// us in a readable unit.
std::string span_text(std::int64_t us) {
  const double size = std::abs(static_cast<double>(us));
  if (size < 1e3) return fmt::format("{:.0f} us", size);
  if (size < 1e6) return fmt::format("{:.1f} ms", size * 1e-3);
  if (size < 86'400e6) return fmt::format("{:.3f} s", size * 1e-6);
  return fmt::format("{:.1f} days", size * 1e-6 / 86'400);
}

std::string clock_text(const Sensor& sensor) {
  const auto difference = sensor.clock_difference();
  if (!difference) return "the stamps are out of range: the device has no time";
  constexpr std::int64_t kAgrees = 20'000;  // us, as in the driver
  const std::string apart =
      fmt::format("{} {} the host's", span_text(*difference), *difference < 0 ? "behind" : "ahead of");
  return fmt::format("device {}, {}: {}", utc(*sensor.last_stamp()), apart,
                     std::abs(*difference) <= kAgrees ? "it can be used" : "not set, the host's time is to be used");
}

std::string refusals_text(const Counters& counters) {
  std::string text;
  for (const auto& [name, count] : counters.values()) {
    if (!name.starts_with("refused.") || count == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
  }
  return text.empty() ? "none" : text;
}

std::string rpm_text(const Sensor& sensor) {
  const std::int64_t set = sensor.facts().values["device.rpm_set"];
  return fmt::format("{:.1f} rpm{}", sensor.rpm(), set > 0 ? fmt::format(" (set: {})", set) : "");
}

std::string sensor_text(const Packets& packets, const Device& device) {
  std::int32_t revolutions = 0;
  Sensor sensor(*device.model, [&](const lidar_points_t& points) { revolutions = points.revolution + 1; });
  const auto mine = [&](const Packets::Handler& handler) {
    packets.for_each([&](const Packet& packet) {
      if (packet.sender == device.address) handler(packet);
    });
  };
  mine([&](const Packet& packet) { sensor.prepare(packet); });
  sensor.finish_preparing();
  const Counters before = sensor.counters();
  mine([&](const Packet& packet) { sensor.on_packet(packet); });
  sensor.finish();
  Counters counters = sensor.counters();
  for (const auto& [name, count] : before.values()) counters.add(name, name.starts_with("refused.") ? -count : 0);

  const lidar::models::DeviceFacts& facts = sensor.facts();
  std::string text = line("points", fmt::format("{} in {} packets of {} revolutions; besides {} shots without a "
                                                "return, {} nearer than 0.4 m or farther than 150 m",
                                                counters["points"], counters["packets"], revolutions,
                                                counters["no_return"], counters["out_of_range"]));
  text += line("lost", fmt::format("{} packets", counters["lost.packets"]));
  text += line("refused", refusals_text(counters));
  text += line("returns", sensor.return_mode().empty() ? "not sent" : sensor.return_mode());
  text += line("speed", rpm_text(sensor));
  const std::string identity = to_text(facts.identity);
  text += line("identity", identity.empty() ? "not sent" : identity);
  text += line("angles", facts.angles_known ? "the device's own" : "nominal: the device has not sent its own");
  text += line("clock", clock_text(sensor));
  for (const auto& [name, value] : facts.values.values()) text += line("", fmt::format("{} = {}", name, value));
  for (const std::string& fault : facts.faults) text += line("fault", fault);
  return text;
}

std::string device_text(const Packets& packets, const Device& device) {
  const Sender kind = device.streams.front().kind;
  std::string text = fmt::format(
      "\n{}: {}\n", lidar::sources::to_text(device.address),
      device.model ? fmt::format("{} (model: {})", lidar::models::table_of(*device.model).title,
                                 lidar::models::table_of(*device.model).name)
                   : fmt::format("{}, whose points this program does not read", lidar::models::title_of(kind)));
  for (std::size_t i = 0; i < std::min(device.streams.size(), kMaxStreams); ++i)
    text += line("port", stream_text(device.streams[i]));
  return device.model ? text + sensor_text(packets, device) : text;
}

}  // namespace

std::string info_text(const Packets& packets, const std::string& name) {
  const std::vector<Device> devices = devices_in(packets);
  std::int64_t count = 0;
  for (const Device& device : devices) count += device.packets();
  std::string text =
      fmt::format("{}: {} UDP packets of {} senders{}\n", name, count, devices.size(), packets.skipped());
  for (std::size_t i = 0; i < std::min(devices.size(), kMaxDevices); ++i) text += device_text(packets, devices[i]);
  if (devices.size() > kMaxDevices) text += fmt::format("\n{} more senders\n", devices.size() - kMaxDevices);
  return text;
}

}  // namespace curbstone::lidar_tool
