#include "services/viewer/foxglove_node.hpp"

namespace curbstone::viewer {

void FoxgloveNode::connect(Subscriber& bus) {
  subscriber_ = &bus;
  bus.subscribe<service_status_t>("SERVICE_STATUS", [this](const service_status_t& m) { show_.on(m); });
}

void FoxgloveNode::tick(std::int64_t now) {
  node_.want_scan(door_.wants(foxglove::kScan));
  points_wanted_ = door_.wants(foxglove::kPoints);
  if (points_wanted_ && !points_subscribed_ && subscriber_ != nullptr) {
    points_subscribed_ = true;
    subscriber_->subscribe<map_points_t>("MAP_POINTS", [this](const map_points_t& m) {
      if (points_wanted_) show_.on(m);
    });
  }
  door_.tick(show_.world(), now);
}

NodeReport FoxgloveNode::report() const {
  NodeReport report;
  report.counters = door_.counters();
  for (const auto& [name, value] : show_.counters().values()) report.counters.add(name, value);
  return report;
}

}  // namespace curbstone::viewer
