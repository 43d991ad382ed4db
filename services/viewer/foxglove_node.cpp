#include "services/viewer/foxglove_node.hpp"

namespace curbstone::viewer {

void FoxgloveNode::connect(Subscriber& bus) {
  subscriber_ = &bus;
  bus.subscribe<service_status_t>("SERVICE_STATUS", [this](const service_status_t& m) { state_.on(m); });
}

void FoxgloveNode::tick(std::int64_t now) {
  node_.want_scan(endpoint_.wants(foxglove::kScan));
  points_wanted_ = endpoint_.wants(foxglove::kPoints);
  if (points_wanted_ && !points_subscribed_ && subscriber_ != nullptr) {
    points_subscribed_ = true;
    subscriber_->subscribe<map_points_t>("MAP_POINTS", [this](const map_points_t& m) {
      if (points_wanted_) state_.on(m);
    });
  }
  endpoint_.tick(state_.world(), now);
}

NodeReport FoxgloveNode::report() const {
  NodeReport report;
  report.counters = endpoint_.counters();
  for (const auto& [name, value] : state_.counters().values()) report.counters.add(name, value);
  return report;
}

}  // namespace curbstone::viewer
