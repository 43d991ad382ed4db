#include "drivers/lidar/packet_feed.hpp"

#include <spdlog/spdlog.h>

#include "common/time/clock.hpp"

namespace curbstone::lidar {

namespace {

class NetworkFeed final : public PacketFeed {
 public:
  NetworkFeed(const LidarConfig& config, LidarNode& node, EventLoop& loop) {
    const sources::UdpOptions options{config.host_address, config.group_address, config.receive_buffer};
    open(config.msop_port, options, node, loop);
    if (config.difop_port != config.msop_port) open(config.difop_port, options, node, loop);
  }

 private:
  void open(int port, const sources::UdpOptions& options, LidarNode& node, EventLoop& loop) {
    sources::UdpSource& source = *sources_.emplace_back(std::make_unique<sources::UdpSource>(port, options));
    loop.watch(source.fd(), [this, &source, &node] {
      source.receive([&node](auto received, int on_port, auto bytes) { node.on_packet(received, on_port, bytes); });
      std::int64_t dropped = 0;
      for (const auto& each : sources_) dropped += each->dropped();
      node.set_dropped(dropped);
    });
  }
  std::vector<std::unique_ptr<sources::UdpSource>> sources_;
};

/// The packets of a capture that are meant for the driver.
class DriverCapture {
 public:
  explicit DriverCapture(const LidarConfig& config)
      : source_(config.pcap), msop_port_(config.msop_port), difop_port_(config.difop_port) {}

  std::optional<sources::PcapSource::Packet> next() {
    for (;;) {
      const auto packet = source_.next();
      if (!packet || packet->port == msop_port_ || packet->port == difop_port_) return packet;
    }
  }

 private:
  sources::PcapSource source_;
  int msop_port_;
  int difop_port_;
};

class CaptureFeed final : public PacketFeed {
 public:
  CaptureFeed(const LidarConfig& config, LidarNode& node, EventLoop& loop)
      : file_(config.pcap), rate_(config.pcap_rate), capture_(config), node_(node), loop_(loop) {
    pending_ = capture_.next();
    if (!pending_) {
      throw std::runtime_error(file_ + ": no UDP packet to port " + std::to_string(config.msop_port) + " or " +
                               std::to_string(config.difop_port) + " in it");
    }
    begin_ = pending_->received;
    loop.every(std::chrono::milliseconds(1), [this] { feed(); });
  }

 private:
  void feed() {
    const std::int64_t now = steady_clock();
    if (!started_) started_ = now;
    while (pending_ &&
           static_cast<double>(pending_->received - begin_) <= static_cast<double>(now - *started_) * rate_) {
      node_.on_packet(pending_->received, pending_->port, pending_->bytes);
      ++count_;
      pending_ = capture_.next();
    }
    if (pending_) return;
    if (!ended_) spdlog::info("{}: end of the capture after {} packets", file_, count_);
    ended_ = true;
    loop_.stop();
  }

  std::string file_;
  double rate_;
  DriverCapture capture_;
  LidarNode& node_;
  EventLoop& loop_;
  std::optional<sources::PcapSource::Packet> pending_;
  std::int64_t begin_ = 0;
  std::optional<std::int64_t> started_;
  std::int64_t count_ = 0;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<PacketFeed> feed_from_network(const LidarConfig& config, LidarNode& node, EventLoop& loop) {
  return std::make_unique<NetworkFeed>(config, node, loop);
}

std::unique_ptr<PacketFeed> feed_from_capture(const LidarConfig& config, LidarNode& node, EventLoop& loop) {
  return std::make_unique<CaptureFeed>(config, node, loop);
}

std::int64_t feed_whole_capture(const LidarConfig& config, LidarNode& node) {
  DriverCapture capture(config);
  std::int64_t count = 0;
  for (auto packet = capture.next(); packet; packet = capture.next(), ++count) {
    node.on_packet(packet->received, packet->port, packet->bytes);
  }
  return count;
}

}  // namespace curbstone::lidar
