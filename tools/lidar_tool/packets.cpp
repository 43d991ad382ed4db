#include "tools/lidar_tool/packets.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/time/clock.hpp"
#include "drivers/lidar/sources/capture_contents.hpp"
#include "drivers/lidar/sources/pcap_source.hpp"
#include "drivers/lidar/sources/udp_source.hpp"

namespace curbstone::lidar_tool {

namespace {

class CapturedPackets final : public Packets {
 public:
  explicit CapturedPackets(std::string file) : file_(std::move(file)) {
    lidar::sources::PcapSource check(file_);  // throws if the file is invalid
  }
  void for_each(const Handler& handler) const override {
    lidar::sources::PcapSource source(file_);
    try {
      while (const auto packet = source.next())
        handler({packet->received, packet->sender, packet->port, packet->bytes});
    } catch (const std::runtime_error& cut_off) {
      if (!damaged_) fmt::print(stderr, "curbstone lidar: {}\n", cut_off.what());
      damaged_ = true;
    }
    skipped_ = lidar::sources::to_text(source.skipped());
  }
  [[nodiscard]] bool damaged() const override { return damaged_; }
  [[nodiscard]] std::string skipped() const override { return skipped_; }

 private:
  std::string file_;
  mutable bool damaged_ = false;  // and reported
  mutable std::string skipped_;
};

class ListenedPackets final : public Packets {
 public:
  void add(const Packet& packet) { packets_.push_back({packet, {packet.bytes.begin(), packet.bytes.end()}}); }
  void for_each(const Handler& handler) const override {
    for (const Kept& kept : packets_) {
      Packet packet = kept.packet;
      packet.bytes = kept.bytes;
      handler(packet);
    }
  }
  [[nodiscard]] bool empty() const { return packets_.empty(); }

 private:
  struct Kept {
    Packet packet;
    std::vector<std::uint8_t> bytes;
  };
  std::vector<Kept> packets_;
};

constexpr std::pair<int, int> kInfoPorts[] = {{6699, 7788}, {2368, 8308}};

int info_port_of(int port) {
  const auto* found = std::ranges::find(kInfoPorts, port, [](const auto& pair) { return pair.first; });
  return found == std::end(kInfoPorts) ? 0 : found->second;
}

void receive(lidar::sources::UdpSource& source, const Packets::Handler& on_packet) {
  source.receive([&](std::int64_t received, int port, std::span<const std::uint8_t> bytes) {
    on_packet({received, source.sender(), port, bytes});
  });
}

}  // namespace

bool is_port(const std::string& where) {
  return !where.empty() && where.size() <= 5 && std::ranges::all_of(where, [](char c) { return c >= '0' && c <= '9'; });
}

void listen(int port, const ListenOptions& options, const Packets::Handler& on_packet,
            const std::function<void(std::int64_t now)>& on_time) {
  if (port < 1 || port > 65535) throw std::runtime_error(fmt::format("{}: no UDP port: 1 to 65535", port));
  lidar::sources::UdpSource points(port, {});
  const int info_port = options.info_port != 0 ? options.info_port : info_port_of(port);
  std::optional<lidar::sources::UdpSource> info;
  if (info_port != 0 && info_port != port) info.emplace(info_port, lidar::sources::UdpOptions{});
  const std::int64_t end = steady_clock() + static_cast<std::int64_t>(options.seconds * 1e6);
  while (steady_clock() < end) {
    pollfd watched[] = {{points.fd(), POLLIN, 0}, {info ? info->fd() : -1, POLLIN, 0}};
    poll(watched, 2, 100);
    receive(points, on_packet);
    if (info) receive(*info, on_packet);
    on_time(wall_clock());
  }
}

std::unique_ptr<Packets> packets_from(const std::string& where, const ListenOptions& options) {
  if (!is_port(where)) return std::make_unique<CapturedPackets>(where);
  auto packets = std::make_unique<ListenedPackets>();
  listen(
      std::stoi(where), options, [&](const Packet& packet) { packets->add(packet); }, [](std::int64_t) {});
  if (packets->empty())
    throw std::runtime_error(fmt::format(
        "no packet came to port {} within {:.1f} s: is the device on, is this host's address the one that it "
        "sends to, is the cable in? 'tcpdump -ni any udp' shows what comes",
        where, options.seconds));
  return packets;
}

}  // namespace curbstone::lidar_tool
