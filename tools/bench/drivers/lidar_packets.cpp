#include "tools/bench/drivers/lidar_packets.hpp"

#include <cmath>
#include <filesystem>
#include <optional>
#include <random>
#include <stdexcept>

#include "drivers/lidar/driver_capture.hpp"
#include "drivers/lidar/models/model_vote.hpp"
#include "tools/simulate/devices/make_lidar.hpp"

namespace curbstone::bench::drivers {

namespace {

using lidar::models::ModelName;
using simulate::devices::LidarName;

constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us
constexpr double kRpm = 1200;
constexpr double kReturns = 0.85;  // of the shots

LidarName emulated(ModelName model) {
  switch (model) {
    case ModelName::kVlp16:
      return LidarName::kVlp16;
    case ModelName::kHelios16p:
      return LidarName::kHelios16p;
    case ModelName::kHelios32:
      return LidarName::kHelios32;
    case ModelName::kAuto:
    case ModelName::kRs16:
      break;
  }
  return LidarName::kRs16;
}

}  // namespace

double LidarPackets::pace() const {
  return static_cast<double>(points.size() - 1) * 1e6 /
         static_cast<double>(points.back().received - points.front().received);
}

LidarPackets emulated_packets(ModelName model, double seconds) {
  const auto device = simulate::devices::make_lidar(emulated(model), kRpm);
  const auto& table = device->table();
  LidarPackets packets{std::string(table.name), model, {}, {}};
  for (int i = 0; i < 2; ++i) packets.infos.push_back({kStart + i, device->info(kStart + i)});

  std::mt19937 random(1);
  std::bernoulli_distribution returned(kReturns);
  std::uniform_real_distribution<float> range(2.0F, 40.0F);
  std::vector<simulate::devices::LidarShot> shots(static_cast<std::size_t>(table.lasers));
  const auto firings = static_cast<std::int64_t>(seconds / table.firing_period);
  for (std::int64_t firing = 0; firing < firings; ++firing) {
    for (auto& shot : shots) {
      shot.range_m = returned(random) ? range(random) : 0.0F;
      shot.intensity = static_cast<std::uint8_t>(random() % 256);
    }
    const std::int64_t utime = kStart + std::llround(static_cast<double>(firing) * table.firing_period * 1e6);
    const double azimuth = static_cast<double>(firing) * device->azimuth_step();
    if (auto bytes = device->add_firing(utime, azimuth, shots)) {
      constexpr std::int64_t kOnTheWay = 200;  // us
      packets.points.push_back({utime + kOnTheWay, std::move(*bytes)});
    }
  }
  return packets;
}

LidarPackets captured_packets(const std::string& file) {
  lidar::LidarConfig config;
  config.model = ModelName::kAuto;
  config.pcap = file;
  LidarPackets packets{std::filesystem::path(file).filename().string(), {}, {}, {}};
  lidar::models::ModelVote vote;
  if (lidar::has_one_info(config)) vote.expect_one_info();
  std::optional<ModelName> model;
  std::vector<TimedPacket> all;
  for (lidar::DriverCapture capture(config, false); const auto& packet = capture.packet(); capture.advance()) {
    if (!model) model = vote.offer(packet->bytes);
    all.push_back({packet->received, {packet->bytes.begin(), packet->bytes.end()}});
  }
  if (!model) throw std::runtime_error(file + ": no packets of a LiDAR that the driver speaks");
  packets.model = *model;
  const auto reader = lidar::models::make_model(*model, {});
  for (TimedPacket& packet : all) {
    const auto kind = reader->kind_of(lidar::models::sender_of(packet.bytes));
    if (kind == lidar::models::PacketKind::kInfo)
      packets.infos.push_back(std::move(packet));
    else if (kind == lidar::models::PacketKind::kPoints)
      packets.points.push_back(std::move(packet));
  }
  // A driver accepts device information once two packets agree, and a short capture may have only one.
  if (packets.infos.size() == 1) packets.infos.push_back(packets.infos.front());
  if (packets.points.size() < 2) throw std::runtime_error(file + ": fewer than two point packets");
  return packets;
}

}  // namespace curbstone::bench::drivers
