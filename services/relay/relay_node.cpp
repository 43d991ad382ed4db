#include "services/relay/relay_node.hpp"

#include <fmt/format.h>

#include "common/time/has_passed.hpp"

namespace curbstone::relay {

namespace {

constexpr std::int64_t kSecond = 1'000'000;     // us
constexpr std::int64_t kSilence = 3 * kSecond;  // three heartbeats

}  // namespace

RelayNode::RelayNode(const RelayConfig& config, const BusAddress& bus, std::uint64_t run)
    : bus_(bus), sender_(bus), peers_(config.port, peer_addresses(config), run) {
  for (const std::string& channel : split_list(config.except)) except_.insert(channel);
  bus_.pass_all();
}

void RelayNode::forward_to_peers() {
  bus_.receive([this](const BusSocket::Message& message) {
    if (message.port == sender_.port()) return;  // it came from a peer: forwarding it would create a loop
    if (except_.contains(message.channel)) return;
    peers_.send(message.channel, message.bytes);
    counters_.add("messages_out");
    counters_.add("bytes_out", static_cast<std::int64_t>(message.bytes.size()));
  });
}

void RelayNode::forward_to_bus(std::int64_t now) {
  peers_.receive(now, [this](std::string_view channel, std::span<const std::uint8_t> data) {
    counters_.add(sender_.send(channel, data) ? "messages_in" : "faults.publish");
    counters_.add("bytes_in", static_cast<std::int64_t>(data.size()));
  });
}

void RelayNode::tick(std::int64_t now) {
  now_ = now;
  if (start_ == 0) start_ = now;
  if (!has_passed(kSecond, last_sign_, now)) return;
  last_sign_ = now;
  peers_.send({}, {});
}

NodeReport RelayNode::report() const {
  NodeReport report;
  report.counters = counters_;
  report.counters.set(peers_.counters());
  report.counters.set("dropped.kernel", bus_.dropped());
  for (const std::string& peer : peers_.silent(now_, start_, kSilence))
    report.faults.push_back(fmt::format("the relay at {} is silent: nothing is exchanged with that host", peer));
  return report;
}

}  // namespace curbstone::relay
