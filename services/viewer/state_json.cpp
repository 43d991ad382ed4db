#include "services/viewer/state_json.hpp"

#include <nlohmann/json.hpp>

#include "common/geometry/geometry.hpp"
#include "common/json/json_text.hpp"

namespace curbstone::viewer {
namespace {

using nlohmann::json;

json pose_json(const map_pose_t& pose) {
  const Pose T_map_base = pose_from_arrays(pose.map_base_position, pose.map_base_orientation);
  const Eigen::Vector3d rpy = roll_pitch_yaw(T_map_base.linear());
  const auto at = [&](std::size_t row, std::size_t column) { return pose.covariance[row * 6 + column]; };
  return {{"utime", pose.utime},
          {"x", pose.map_base_position[0]},
          {"y", pose.map_base_position[1]},
          {"z", pose.map_base_position[2]},
          {"roll", rpy.x()},
          {"pitch", rpy.y()},
          {"yaw", rpy.z()},
          {"covariance", {at(0, 0), at(0, 1), at(1, 1), at(5, 5)}},
          {"residual", pose.residual},
          {"inliers", pose.inlier_ratio},
          {"degenerate", pose.degenerate},
          {"registered", (pose.flags & map_pose_t::REGISTERED) != 0},
          {"without_odometry", (pose.flags & map_pose_t::NO_ODOMETRY) != 0},
          {"stationary", (pose.flags & map_pose_t::STATIONARY) != 0},
          {"lost", (pose.flags & map_pose_t::LOST) != 0}};
}

json localized_json(const State& state) {
  if (!state.localized) return {};
  json localized = pose_json(*state.localized);
  localized["age"] = state.localized_age;
  localized["here"] = state.localized->epoch == state.epoch;
  return localized;
}

json playback_json(const Playback& playback) {
  return {{"position", playback.position},
          {"progress", playback.progress},
          {"speed", playback.speed},
          {"paused", playback.paused},
          {"ended", playback.ended}};
}

}  // namespace

std::string state_json(const State& state, const VehicleConfig& vehicle) {
  return json_text({{"source", state.source},
                    {"title", state.title},
                    {"epoch", state.epoch},
                    {"tiles", state.tiles},
                    {"behind", state.behind},
                    {"bus_age", state.bus_age},
                    {"tile_age", state.tile_age},
                    {"index_age", state.index_age},
                    {"pose_age", state.pose_age},
                    {"new_map_age", state.new_map_age},
                    {"latency", {state.latency_p50, state.latency_p95}},
                    {"vehicle", {vehicle.length, vehicle.width, vehicle.middle}},
                    {"pose", state.pose ? pose_json(*state.pose) : json()},
                    {"localized", localized_json(state)},
                    {"playback", state.playback ? playback_json(*state.playback) : json()}});
}

std::string services_json(const store::Services& services, std::int64_t now) {
  json list = json::array();
  for (const auto& [name, service] : services.all()) {
    json losses = json::array();
    for (const auto& loss : service.losses)
      if (loss.count != 0) losses.push_back({loss.name, loss.count, loss.rate});
    list.push_back({{"name", name},
                    {"host", service.host},
                    {"version", service.version},
                    {"pid", service.pid},
                    {"age", static_cast<double>(now - service.heard) * 1e-6},
                    {"uptime", static_cast<double>(service.uptime) * 1e-6},
                    {"cpu", service.cpu},
                    {"memory", service.memory},
                    {"latency", {service.latency_p50, service.latency_p99}},
                    {"faults", service.faults},
                    {"losses", losses}});
  }
  return json_text(list);
}

}  // namespace curbstone::viewer
