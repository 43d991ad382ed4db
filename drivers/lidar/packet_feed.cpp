#include "drivers/lidar/packet_feed.hpp"

#include <spdlog/spdlog.h>

#include "common/time/clock.hpp"
#include "drivers/lidar/driver_capture.hpp"

namespace curbstone::lidar {

namespace {

class NetworkFeed final : public PacketFeed {
 public:
  NetworkFeed(const LidarConfig& config, LidarNode& node, EventLoop& loop) {
    const sources::UdpOptions options{config.host_address, config.group_address, config.receive_buffer,
                                      config.device_address};
    open(config.msop_port, options, node, loop);
    if (config.difop_port != config.msop_port) open(config.difop_port, options, node, loop);
  }

 private:
  void open(int port, const sources::UdpOptions& options, LidarNode& node, EventLoop& loop) {
    sources::UdpSource& source = *sources_.emplace_back(std::make_unique<sources::UdpSource>(port, options));
    loop.watch(source.fd(), [this, &source, &node] {
      source.receive([&node](auto received, int on_port, auto bytes) { node.on_packet(received, on_port, bytes); });
      std::int64_t dropped = 0, foreign = 0;
      for (const auto& each : sources_) {
        dropped += each->dropped();
        foreign += each->foreign();
      }
      node.set_dropped(dropped);
      if (foreign > 0) node.set_counter("refused.source", foreign);
    });
  }
  std::vector<std::unique_ptr<sources::UdpSource>> sources_;
};

/// What of a capture did not reach the node.
void count_refused(const DriverCapture& capture, LidarNode& node) {
  if (capture.foreign() > 0) node.set_counter("refused.source", capture.foreign());
  if (capture.fragments() > 0) node.set_counter("refused.fragment", capture.fragments());
  if (capture.cut() > 0) node.set_counter("refused.cut_off", capture.cut());
}

class CaptureFeed final : public PacketFeed {
 public:
  CaptureFeed(const LidarConfig& config, LidarNode& node, EventLoop& loop)
      : file_(config.pcap), rate_(config.pcap_rate), capture_(config, config.pcap_repeat), node_(node), loop_(loop) {
    begin_ = capture_.packet()->received;
    loop.every(std::chrono::milliseconds(1), [this] { feed(); });
  }

 private:
  void feed() {
    const std::int64_t now = steady_clock();
    if (!started_) started_ = now;
    const auto& packet = capture_.packet();
    while (packet && static_cast<double>(packet->received - begin_) <= static_cast<double>(now - *started_) * rate_) {
      node_.on_packet(packet->received, packet->port, packet->bytes);
      ++count_;
      capture_.advance();
    }
    count_refused(capture_, node_);
    if (packet) return;
    if (!ended_) spdlog::info("{}: end of the capture after {} packets", file_, count_);
    ended_ = true;
    loop_.stop();
  }

  std::string file_;
  double rate_;
  DriverCapture capture_;
  LidarNode& node_;
  EventLoop& loop_;
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
  DriverCapture capture(config, false);
  std::int64_t count = 0;
  for (; const auto& packet = capture.packet(); capture.advance(), ++count)
    node.on_packet(packet->received, packet->port, packet->bytes);
  count_refused(capture, node);
  return count;
}

}  // namespace curbstone::lidar
