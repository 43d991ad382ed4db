#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/bus/node.hpp"
#include "tools/replay/stage_queue.hpp"

namespace curbstone::replay {

/// Nodes on their own bus, which messages enter and leave in order: a part of a StageLine. One thread.
class StageGroup {
 public:
  using Out = std::function<void(LineItem)>;
  /// The nodes are ticked at each beat whose number is a multiple of `beats_per_tick`.
  explicit StageGroup(int beats_per_tick);

  [[nodiscard]] LocalBus& bus() { return bus_; }
  /// Takes a node that was constructed with bus(). Nodes are ticked in the order of adding.
  void add(Node& node);
  [[nodiscard]] bool hears(const std::string& channel) const { return bus_.hears(channel); }

  /// Called with every message that the nodes publish, at the time of publishing.
  void when_published(Out out) { out_ = std::move(out); }
  void deliver(const LineItem& message);
  void beat(const LineItem& beat);
  /// No measurement follows.
  void end_drive();
  /// Finishes all pending work.
  void finish();

 private:
  void tick(std::int64_t now);

  int beats_per_tick_;
  LocalBus bus_;
  std::vector<Node*> nodes_;
  Out out_;
  bool injects_ = false;        // set during delivery, so that an incoming message is not taken for an outgoing one
  bool due_ = false;            // a tick is overdue: its beat did not advance message time
  std::int64_t last_beat_ = 0;  // us
};

}  // namespace curbstone::replay
