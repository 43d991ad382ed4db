#pragma once

#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"

namespace curbstone::test {

/// A bus that keeps what a node publishes on one channel.
template <class Message>
class Recorder {
 public:
  explicit Recorder(const std::string& channel) {
    bus_.subscribe<Message>(channel, [this](const Message& message) { messages_.push_back(message); });
  }
  LocalBus& bus() { return bus_; }
  const std::vector<Message>& messages() {
    bus_.dispatch();
    return messages_;
  }

 private:
  LocalBus bus_;
  std::vector<Message> messages_;
};

}  // namespace curbstone::test
