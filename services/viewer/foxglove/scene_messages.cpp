#include "services/viewer/foxglove/scene_messages.hpp"

#include <fmt/format.h>
#include <foxglove/scene.pb.h>

#include <algorithm>
#include <array>

#include "services/viewer/foxglove/message_parts.hpp"

namespace curbstone::viewer::foxglove {
namespace {

constexpr std::array<double, 3> kCurbColour = {0.10, 0.85, 0.30};  // red, green, blue
constexpr std::array<double, 3> kLoweredColour = {1.00, 0.60, 0.10};
constexpr std::array<double, 3> kInferredColour = {0.60, 0.60, 0.65};
constexpr std::array<double, 3> kPathColour = {0.20, 0.55, 1.00};
constexpr double kThick = 0.06;  // m
constexpr double kThin = 0.02;

::foxglove::SceneEntity& add_entity(::foxglove::SceneUpdate& scene, const std::string& id, std::int64_t utime) {
  auto& entity = *scene.add_entities();
  set_time(*entity.mutable_timestamp(), utime);
  entity.set_frame_id("map");
  entity.set_id(id);
  return entity;
}

::foxglove::LinePrimitive& add_line(::foxglove::SceneEntity& entity, const std::array<double, 3>& colour,
                                    double thickness) {
  auto& line = *entity.add_lines();
  line.set_type(::foxglove::LinePrimitive::LINE_STRIP);
  set_pose(*line.mutable_pose(), Pose::Identity());
  line.set_thickness(thickness);
  line.mutable_color()->set_r(colour[0]);
  line.mutable_color()->set_g(colour[1]);
  line.mutable_color()->set_b(colour[2]);
  line.mutable_color()->set_a(1);
  return line;
}

void add_metadata(::foxglove::SceneEntity& entity, const std::string& key, const std::string& value) {
  auto& pair = *entity.add_metadata();
  pair.set_key(key);
  pair.set_value(value);
}

void delete_all(::foxglove::SceneUpdate& scene, std::int64_t utime) {
  auto& deletion = *scene.add_deletions();
  set_time(*deletion.mutable_timestamp(), utime);
  deletion.set_type(::foxglove::SceneEntityDeletion::ALL);
}

std::string curb_id(std::uint32_t name) {
  return fmt::format("curb {}", name);
}

float middle_of(std::vector<float> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void add_curb(::foxglove::SceneUpdate& scene, const store::CurbLines::News::Added& added, std::int64_t utime) {
  const curb_line_t& curb = *added.line;
  auto& entity = add_entity(scene, curb_id(added.name), utime);
  const auto& colour = curb.inferred != 0 ? kInferredColour : curb.dropped != 0 ? kLoweredColour : kCurbColour;
  auto& foot = add_line(entity, colour, kThin);
  auto& edge = add_line(entity, colour, kThick);
  for (std::size_t i = 0; i < curb.x.size(); ++i) {
    const double x = double{curb.x[i]};
    const double y = double{curb.y[i]};
    const double z = double{curb.z[i]};
    set_vector(*foot.add_points(), x, y, z);
    set_vector(*edge.add_points(), x, y, z + double{curb.height[i]});
  }
  add_metadata(entity, "height", fmt::format("{:.3f} m", middle_of(curb.height)));
  add_metadata(entity, "rise", curb.rise > 0 ? "up" : curb.rise < 0 ? "down" : "unknown");
  add_metadata(entity, "confidence", fmt::format("{:.2f}", curb.confidence));
  add_metadata(entity, "lowered", curb.dropped != 0 ? "yes" : "no");
  add_metadata(entity, "inferred", curb.inferred != 0 ? "yes" : "no");
}

}  // namespace

std::string curbs_message(const store::CurbLines::News& news, std::int64_t utime) {
  ::foxglove::SceneUpdate scene;
  if (news.everything) delete_all(scene, utime);
  for (const std::uint32_t name : news.gone) {
    auto& deletion = *scene.add_deletions();
    set_time(*deletion.mutable_timestamp(), utime);
    deletion.set_id(curb_id(name));
  }
  for (const auto& added : news.added) add_curb(scene, added, utime);
  return scene.SerializeAsString();
}

std::string path_message(const store::DrivenPath& path, std::size_t first, bool everything, std::int64_t utime) {
  ::foxglove::SceneUpdate scene;
  if (everything) delete_all(scene, utime);
  const auto& points = path.points();
  const std::size_t from =
      everything || first == 0 ? 0 : (first - 1) / kPathPiece;  // a piece ends with the next one's first
  for (std::size_t piece = from; piece * kPathPiece < points.size(); ++piece) {
    auto& entity = add_entity(scene, fmt::format("path {}", piece), utime);
    auto& line = add_line(entity, kPathColour, kThick);
    const std::size_t end = std::min(points.size(), (piece + 1) * kPathPiece + 1);
    for (std::size_t i = piece * kPathPiece; i < end; ++i)
      set_vector(*line.add_points(), double{points[i].x}, double{points[i].y}, double{points[i].z});
  }
  return scene.SerializeAsString();
}

}  // namespace curbstone::viewer::foxglove
