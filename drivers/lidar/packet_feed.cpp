#include "drivers/lidar/packet_feed.hpp"

#include <fmt/format.h>

#include <set>

#include "common/time/clock.hpp"
#include "common/time/replay_pace.hpp"
#include "common/time/retry_backoff.hpp"
#include "drivers/lidar/driver_capture.hpp"
#include "drivers/lidar/sources/one_sender.hpp"

namespace curbstone::lidar {

namespace {

/// Three packets of a spinning LiDAR, whose stamps are the kernel's: to be woken for each costs more than to decode it.
constexpr std::chrono::microseconds kGather(4000);

class NetworkFeed final : public PacketFeed {
 public:
  NetworkFeed(const LidarConfig& config, LidarNode& node, EventLoop& loop)
      : options_{config.host_address, config.group_address, config.receive_buffer, config.device_address},
        ports_(ports_of(config)),
        node_(node),
        loop_(loop) {
    loop_.gather(kGather);
    try_to_open();
    if (!open_) loop_.every(std::chrono::milliseconds(50), [this] { try_again(); });
    loop_.every(std::chrono::milliseconds(100), [this] { node_.set_sender_fault(sender_.fault(wall_clock())); });
  }

 private:
  void try_again() {
    if (!open_ && retry_.due(steady_clock())) try_to_open();
  }

  /// Opens all ports or none. A missing interface may appear later, and a port be given up: another driver that ends a
  /// moment late, a capture tool. All other errors need another configuration.
  void try_to_open() {
    try {
      for (const int port : ports_) sources_.push_back(std::make_unique<sources::UdpSource>(port, options_));
    } catch (const sources::PortUnavailable& unavailable) {
      sources_.clear();
      if (!tried_) node_.print(fmt::format("{}; it is tried again until it can be opened", unavailable.what()));
      tried_ = true;
      node_.set_source_fault(unavailable.what());
      retry_.failed(steady_clock());
      return;
    }
    open_ = true;
    if (tried_) node_.print("the port is open: listening");
    node_.set_source_fault("");
    for (const auto& source : sources_) {
      node_.set_receive_buffer(options_.receive_buffer, source->receive_buffer());
      loop_.watch(source->fd(), [this, listening = source.get()] { receive(*listening); });
    }
  }

  void receive(sources::UdpSource& source) {
    source.receive([&](auto received, int on_port, auto bytes) {
      if (!sender_.admits(source.sender(), received, node_.role_of_packet(bytes))) return;
      if (sender_.is_another()) node_.forget_device();
      node_.on_packet(received, on_port, bytes);
    });
    std::int64_t dropped = 0, foreign = sender_.foreign();
    for (const auto& each : sources_) {
      dropped += each->dropped();
      foreign += each->foreign();
    }
    node_.set_dropped(dropped);
    if (foreign > 0) node_.set_counter("refused.source", foreign);
  }

  sources::UdpOptions options_;
  std::set<int> ports_;
  LidarNode& node_;
  EventLoop& loop_;
  std::vector<std::unique_ptr<sources::UdpSource>> sources_;
  sources::OneSender sender_;
  bool open_ = false;
  bool tried_ = false;
  RetryBackoff retry_;
};

/// Counts packets of a capture that did not reach the node.
void count_refused(const DriverCapture& capture, LidarNode& node) {
  if (capture.foreign() > 0) node.set_counter("refused.source", capture.foreign());
  node.set_sender_fault(capture.sender_fault());
  if (capture.fragments() > 0) node.set_counter("refused.fragment", capture.fragments());
  if (capture.cut() > 0) node.set_counter("refused.cut_off", capture.cut());
}

constexpr int kMaxAtOnce = 1000;  // packets per millisecond: a capture may have times that would block the loop

class CaptureFeed final : public PacketFeed {
 public:
  CaptureFeed(const LidarConfig& config, LidarNode& node, EventLoop& loop)
      : file_(config.pcap), pace_(config.pcap_rate), capture_(config, config.pcap_repeat), node_(node), loop_(loop) {
    if (has_one_info(config)) node_.expect_one_info();
    loop.every(std::chrono::milliseconds(1), [this] { feed(); });
  }

 private:
  void feed() {
    const std::int64_t now = steady_clock();
    const auto& packet = capture_.packet();
    for (int i = 0; i < kMaxAtOnce && packet && pace_.due(packet->received, now); ++i) {
      if (capture_.is_another()) node_.forget_device();
      node_.on_packet(packet->received, packet->port, packet->bytes);
      ++count_;
      capture_.advance();
    }
    count_refused(capture_, node_);
    if (packet) return;
    if (!ended_) node_.print(fmt::format("{}: end of the capture after {} packets", file_, count_));
    ended_ = true;
    loop_.stop();
  }

  std::string file_;
  ReplayPace pace_;
  DriverCapture capture_;
  LidarNode& node_;
  EventLoop& loop_;
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
  if (has_one_info(config)) node.expect_one_info();
  for (; const auto& packet = capture.packet(); capture.advance(), ++count) {
    if (capture.is_another()) node.forget_device();
    node.on_packet(packet->received, packet->port, packet->bytes);
  }
  count_refused(capture, node);
  node.finish();
  return count;
}

}  // namespace curbstone::lidar
