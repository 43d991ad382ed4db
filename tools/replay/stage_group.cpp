#include "tools/replay/stage_group.hpp"

namespace curbstone::replay {

StageGroup::StageGroup(int beats_per_tick) : beats_per_tick_(beats_per_tick) {
  bus_.tap([this](const std::string& channel, const void* data, int size, std::int64_t) {
    if (injects_) return;
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    out_({LineItem::Kind::kMessage, channel, {bytes, bytes + size}});
  });
}

void StageGroup::add(Node& node) {
  nodes_.push_back(&node);
  node.connect(bus_);
}

void StageGroup::deliver(const LineItem& message) {
  injects_ = true;
  bus_.inject(message.channel, message.bytes.data(), static_cast<int>(message.bytes.size()));
  injects_ = false;
  bus_.dispatch();
}

void StageGroup::beat(const LineItem& beat) {
  last_beat_ = beat.now;
  due_ = due_ || beat.number % beats_per_tick_ == 0;
  if (!due_ || !beat.ticks) return;
  due_ = false;
  tick(beat.now);
}

void StageGroup::tick(std::int64_t now) {
  for (Node* node : nodes_) {
    node->tick(now);
    bus_.dispatch();
  }
}

void StageGroup::end_drive() {
  for (Node* node : nodes_) {
    node->end_drive();
    bus_.dispatch();
  }
}

void StageGroup::finish() {
  if (last_beat_ != 0) tick(last_beat_);
  for (Node* node : nodes_) {
    node->finish();
    bus_.dispatch();
  }
}

}  // namespace curbstone::replay
