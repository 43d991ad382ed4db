#include "tools/lidar_tool/watch.hpp"

#include <fmt/format.h>

#include <cmath>

namespace curbstone::lidar_tool {

namespace {

constexpr std::int64_t kSecond = 1'000'000;  // us

std::string clock_line(const Sensor& sensor) {
  if (!sensor.clock_difference()) return "no time";
  const double ms = static_cast<double>(*sensor.clock_difference()) * 1e-3;
  return std::abs(ms) < 1000 ? fmt::format("clock {:+.1f} ms", ms) : fmt::format("clock {:+.0f} s", ms * 1e-3);
}

}  // namespace

void Watch::on_packet(const Packet& packet) {
  if (!devices_.contains(packet.sender) && devices_.size() >= kMaxDevices) return;
  Watched& watched = devices_[packet.sender];
  ++watched.packets;
  const lidar::models::Sender kind = lidar::models::sender_of(packet.bytes);
  if (!watched.sensor) {
    watched.kind = kind;
    if (const auto model = model_of(kind)) watched.sensor = std::make_unique<Sensor>(*model);
  }
  if (watched.sensor) watched.sensor->on_packet(packet);
}

std::vector<std::string> Watch::on_time(std::int64_t now) {
  if (began_ == 0) began_ = now;
  if (now - began_ < kSecond) return {};
  began_ = now;
  std::vector<std::string> lines;
  for (auto& [address, watched] : devices_) lines.push_back(line_of(address, watched));
  if (lines.empty()) lines.emplace_back("nothing comes");
  return lines;
}

std::string Watch::line_of(lidar::sources::Ipv4 address, Watched& watched) {
  const std::string who = lidar::sources::to_text(address);
  const std::int64_t packets = std::exchange(watched.packets, 0);
  if (!watched.sensor)
    return fmt::format("{}  {}  {} packets: not read", who, lidar::models::title_of(watched.kind), packets);
  const Sensor& sensor = *watched.sensor;
  const std::int64_t all_lost = sensor.counters()["lost.packets"], all_refused = sensor.refused();
  const std::int64_t lost = all_lost - std::exchange(watched.lost, all_lost);
  const std::int64_t refused = all_refused - std::exchange(watched.refused, all_refused);
  std::string verdict;
  const auto complain = [&](const std::string& text) { verdict += (verdict.empty() ? "" : "; ") + text; };
  if (packets == 0) complain("SILENT");
  if (lost > 0) complain(fmt::format("{} LOST", lost));
  if (refused > 0) complain(fmt::format("{} REFUSED", refused));
  for (const std::string& fault : sensor.facts().faults) complain(fault);
  return fmt::format("{}  {}  {} packets  {:.0f} rpm  {}{}{}  {}", who, sensor.table().name, packets, sensor.rpm(),
                     clock_line(sensor), sensor.return_mode().empty() ? "" : "  ", sensor.return_mode(),
                     verdict.empty() ? "ok" : verdict);
}

}  // namespace curbstone::lidar_tool
