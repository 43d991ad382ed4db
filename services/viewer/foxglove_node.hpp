#pragma once

#include <string>

#include "common/bus/node.hpp"
#include "services/viewer/foxglove/endpoint.hpp"
#include "services/viewer/foxglove_state.hpp"
#include "services/viewer/wanted_channel.hpp"

namespace curbstone::viewer {

/// The Foxglove server beside the page: the same state, in Foxglove's protocol. LIDAR_POINTS and MAP_POINTS load the
/// bus, so they are subscribed to only while a client asks for them.
class FoxgloveNode final : public Node {
 public:
  /// All arguments but `session` must outlive this. `session`: unique for each run of the process.
  FoxgloveNode(const ViewerConfig& config, ViewerNode& node, web::Connections& clients, const std::string& session)
      : node_(node), vehicle_(config.vehicle), state_(node, vehicle_), endpoint_(clients, session) {}

  void connect(Subscriber& bus) override;
  void tick(std::int64_t now) override;
  [[nodiscard]] NodeReport report() const override;

 private:
  ViewerNode& node_;
  VehicleConfig vehicle_;
  FoxgloveState state_;
  foxglove::Endpoint endpoint_;
  Subscriber* subscriber_ = nullptr;
  WantedChannel<map_points_t> points_{"MAP_POINTS", [this](const map_points_t& m) { state_.on(m); }};
};

}  // namespace curbstone::viewer
