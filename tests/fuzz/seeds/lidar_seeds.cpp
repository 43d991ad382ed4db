// LiDAR packets as tests/fuzz/lidar.cpp takes them, and captures of them.
#include "drivers/lidar/sources/pcap_source.hpp"
#include "tests/drivers/lidar/captures.hpp"
#include "tests/fuzz/seeds/seed_folder.hpp"
#include "tools/simulate/devices/make_lidar.hpp"

namespace curbstone::fuzz {
namespace {

using simulate::devices::LidarName;

constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us
constexpr int kPackets = 4;

struct Packet {
  std::int64_t after = 0;  // us
  int port = 0;
  std::vector<std::uint8_t> bytes;
};

/// Two packets of device information, then a few with points.
std::vector<Packet> emulated(LidarName name) {
  const auto lidar = simulate::devices::make_lidar(name, 1200);
  const simulate::devices::LidarTable& table = lidar->table();
  std::vector<Packet> packets = {{0, table.info_port, lidar->info(kStart)},
                                 {1000, table.info_port, lidar->info(kStart)}};
  const std::vector<simulate::devices::LidarShot> shots(static_cast<std::size_t>(table.lasers), {10.0F, 100});
  for (int i = 0; static_cast<int>(packets.size()) < 2 + kPackets; ++i) {
    const auto at = kStart + static_cast<std::int64_t>(i * table.firing_period * 1e6);
    if (auto packet = lidar->add_firing(at, i * lidar->azimuth_step(), shots))
      packets.push_back({static_cast<std::int64_t>(table.packet_period() * 1e6), table.point_port, std::move(*packet)});
  }
  return packets;
}

std::vector<Packet> recorded(const std::filesystem::path& file, int skip) {
  std::vector<Packet> packets;
  if (!std::filesystem::exists(file)) return packets;
  lidar::sources::PcapSource source(file);
  std::int64_t last = 0;
  for (auto packet = source.next(); packet && packets.size() < 6; packet = source.next()) {
    const std::int64_t after = last == 0 ? 0 : packet->received - last;
    last = packet->received;
    if (skip-- <= 0) packets.push_back({after, packet->port, {packet->bytes.begin(), packet->bytes.end()}});
  }
  return packets;
}

Seed seed_of(const std::vector<Packet>& packets) {
  Seed seed;
  for (const Packet& packet : packets) {
    put(seed, static_cast<std::uint16_t>(packet.after / 10));
    put_piece(seed, packet.bytes);
  }
  return seed;
}

void write_capture(const SeedFolder& folder, const std::string& name, const std::vector<Packet>& packets) {
  std::vector<lidar::Bytes> frames;
  for (const Packet& packet : packets) frames.push_back(lidar::frame(packet.bytes, packet.port));
  for (const auto format : {lidar::Capture::Format::kMicroseconds, lidar::Capture::Format::kPcapng}) {
    const lidar::Capture capture(frames, lidar::kEthernet, format, 1332);
    const bool pcapng = format == lidar::Capture::Format::kPcapng;
    folder.write("pcap", name + (pcapng ? ".pcapng" : ".pcap"), SeedFolder::read(capture.name()));
  }
}

}  // namespace

void write_lidar_seeds(const SeedFolder& folder) {
  const std::vector<std::pair<std::string, LidarName>> models = {{"rs16", LidarName::kRs16},
                                                                 {"vlp16", LidarName::kVlp16},
                                                                 {"helios16p", LidarName::kHelios16p},
                                                                 {"helios32", LidarName::kHelios32}};
  for (const auto& [name, model] : models) {
    const std::vector<Packet> packets = emulated(model);
    for (const std::string& target : {name, std::string("lidar_auto")}) folder.write(target, name, seed_of(packets));
    write_capture(folder, name, packets);
  }
  const std::vector<std::pair<std::string, std::string>> recordings = {{"rs16", "rs16/rs16_washing_house.pcap"},
                                                                       {"helios32", "rs16/helios16p.pcap"}};
  for (const auto& [target, recording] : recordings) {
    for (const int skip : {0, 500}) {
      const std::vector<Packet> packets = recorded(folder.recording(recording), skip);
      if (!packets.empty()) folder.write(target, "recorded_" + std::to_string(skip), seed_of(packets));
    }
  }
}

}  // namespace curbstone::fuzz
