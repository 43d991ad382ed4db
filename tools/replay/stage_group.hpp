#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/bus/node.hpp"
#include "tools/replay/stage_queue.hpp"

namespace curbstone::replay {

/// Nodes on a bus of their own, which messages enter and leave in a row: a part of a StageLine. One thread.
class StageGroup {
 public:
  using Out = std::function<void(LineItem)>;
  /// The nodes are ticked at each beat whose number is a multiple of `beats_per_tick`.
  explicit StageGroup(int beats_per_tick);

  [[nodiscard]] LocalBus& bus() { return bus_; }
  /// Takes a node that was made with bus(). In the order in which they are ticked.
  void add(Node& node);
  [[nodiscard]] bool hears(const std::string& channel) const { return bus_.hears(channel); }

  /// Called with every message that the nodes publish, while they do.
  void when_published(Out out) { out_ = std::move(out); }
  void deliver(const LineItem& message);
  void beat(const LineItem& beat);
  /// The drive is over: everything pending is finished.
  void finish();

 private:
  void tick(std::int64_t now);

  int beats_per_tick_;
  LocalBus bus_;
  std::vector<Node*> nodes_;
  Out out_;
  bool injects_ = false;        // so that what comes is not taken for what goes
  bool due_ = false;            // a beat at which the nodes should have been ticked did not tick
  std::int64_t last_beat_ = 0;  // us
};

}  // namespace curbstone::replay
