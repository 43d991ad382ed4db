#include "services/viewer/foxglove_state.hpp"

namespace curbstone::viewer {

void FoxgloveState::on(const service_status_t& message) {
  if (!status_.put(message)) counters_.add("dropped.status");
}

void FoxgloveState::on(const map_points_t& message) {
  if (const auto& pose = node_.pose())
    points_.look_from(pose->epoch, pose->map_base_position[0], pose->map_base_position[1]);
  if (!points_.put(message)) counters_.add("refused.map_points");
}

foxglove::World FoxgloveState::world() const {
  return {.map = node_.world(), .pose = node_.pose(), .vehicle = vehicle_, .status = status_, .points = points_};
}

}  // namespace curbstone::viewer
