#include "services/viewer/foxglove_node.hpp"

namespace curbstone::viewer {

void FoxgloveNode::connect(Subscriber& bus) {
  subscriber_ = &bus;
  bus.subscribe<service_status_t>("SERVICE_STATUS", [this](const service_status_t& m) { state_.on(m); });
}

void FoxgloveNode::tick(std::int64_t now) {
  node_.want_scan(endpoint_.wants(foxglove::kScan));
  points_.tick(now, endpoint_.wants(foxglove::kPoints), subscriber_);
  endpoint_.tick(state_.world(), now);
}

NodeReport FoxgloveNode::report() const {
  NodeReport report;
  report.counters = endpoint_.counters();
  report.counters.add(state_.counters());
  return report;
}

}  // namespace curbstone::viewer
