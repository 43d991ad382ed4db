#include "services/viewer/foxglove/scene_messages.hpp"

#include <fmt/format.h>
#include <foxglove/scene.pb.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "common/statistics/quantile.hpp"
#include "services/viewer/foxglove/message_parts.hpp"

namespace curbstone::viewer::foxglove {
namespace {

constexpr std::array<double, 3> kCurbColour = {0.10, 0.85, 0.30};  // red, green, blue
constexpr std::array<double, 3> kLoweredColour = {1.00, 0.60, 0.10};
constexpr std::array<double, 3> kInferredColour = {0.60, 0.60, 0.65};
constexpr std::array<double, 3> kPathColour = {0.20, 0.55, 1.00};
constexpr std::array<double, 3> kPaintColour = {0.96, 0.97, 0.98};
constexpr double kUnseen = 0.5;       // opacity
constexpr double kPaintWidth = 0.12;  // m, if unknown
constexpr double kPaintRise = 0.02;   // m, above the road, against z-fighting
constexpr double kThick = 0.06;       // m
constexpr double kThin = 0.02;

::foxglove::SceneEntity& add_entity(::foxglove::SceneUpdate& scene, const std::string& id, std::int64_t utime) {
  auto& entity = *scene.add_entities();
  set_time(*entity.mutable_timestamp(), utime);
  entity.set_frame_id("map");
  entity.set_id(id);
  return entity;
}

void set_colour(::foxglove::Color& to, const std::array<double, 3>& colour, double alpha) {
  to.set_r(colour[0]);
  to.set_g(colour[1]);
  to.set_b(colour[2]);
  to.set_a(alpha);
}

::foxglove::LinePrimitive& add_line(::foxglove::SceneEntity& entity, const std::array<double, 3>& colour,
                                    double thickness, double alpha = 1) {
  auto& line = *entity.add_lines();
  line.set_type(::foxglove::LinePrimitive::LINE_STRIP);
  set_pose(*line.mutable_pose(), Pose::Identity());
  line.set_thickness(thickness);
  set_colour(*line.mutable_color(), colour, alpha);
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

std::string id_of(const char* kind, std::uint32_t name) {
  return fmt::format("{} {}", kind, name);
}

/// Deletes the lines removed since the listener's last update, or all lines for a new listener.
template <class Changes>
void add_deletions(::foxglove::SceneUpdate& scene, const Changes& changes, const char* kind, std::int64_t utime) {
  if (changes.everything) delete_all(scene, utime);
  for (const std::uint32_t name : changes.gone) {
    auto& deletion = *scene.add_deletions();
    set_time(*deletion.mutable_timestamp(), utime);
    deletion.set_id(id_of(kind, name));
  }
}

void add_curb(::foxglove::SceneUpdate& scene, const store::CurbLines::Changes::Added& added, std::int64_t utime) {
  const curb_line_t& curb = *added.line;
  auto& entity = add_entity(scene, id_of("curb", added.name), utime);
  const auto& colour = curb.inferred != 0 ? kInferredColour : curb.dropped != 0 ? kLoweredColour : kCurbColour;
  const double alpha = curb.inferred != 0 ? kUnseen : 1;
  auto& foot = add_line(entity, colour, kThin, alpha);
  auto& edge = add_line(entity, colour, curb.inferred != 0 ? kThin : kThick, alpha);
  for (std::size_t i = 0; i < curb.x.size(); ++i) {
    const double x = double{curb.x[i]};
    const double y = double{curb.y[i]};
    const double z = double{curb.z[i]};
    set_vector(*foot.add_points(), x, y, z);
    set_vector(*edge.add_points(), x, y, z + double{curb.height[i]});
  }
  add_metadata(entity, "height",
               fmt::format("{:.3f} m", quantile_or({curb.height.begin(), curb.height.end()}, 0.5, 0)));
  add_metadata(entity, "rise", curb.rise > 0 ? "up" : curb.rise < 0 ? "down" : "unknown");
  add_metadata(entity, "confidence", fmt::format("{:.2f}", curb.confidence));
  add_metadata(entity, "lowered", curb.dropped != 0 ? "yes" : "no");
  add_metadata(entity, "inferred", curb.inferred != 0 ? "yes" : "no");
}

std::string_view name_of(std::int8_t type) {
  static constexpr std::array<std::string_view, 6> kNames = {"unknown",   "solid line", "dashed line",
                                                             "stop line", "crossing",   "other"};
  return kNames.at(type > 0 && type < static_cast<std::int8_t>(kNames.size()) ? static_cast<std::size_t>(type) : 0);
}

/// Unit vector from point to point, in the plane. Empty: the points coincide.
std::optional<Eigen::Vector2d> direction_of(const marking_line_t& line, std::size_t from, std::size_t to) {
  const Eigen::Vector2d step(double{line.x[to]} - double{line.x[from]}, double{line.y[to]} - double{line.y[from]});
  const double length = step.norm();
  if (!(length > 0)) return std::nullopt;
  return step / length;
}

/// Half the width across the strip at a point, along the bisector of the normals of the pieces that meet there, if both
/// are painted.
Eigen::Vector2d half_across(const marking_line_t& line, std::size_t at, bool begins, bool ends, double half_width) {
  const auto before = begins ? std::nullopt : direction_of(line, at - 1, at);
  const auto after = ends ? std::nullopt : direction_of(line, at, at + 1);
  const Eigen::Vector2d along =
      before && after ? Eigen::Vector2d(*before + *after) : before.value_or(after.value_or(Eigen::Vector2d::Zero()));
  const double length = along.norm();
  if (!(length > 0)) return Eigen::Vector2d::Zero();
  // At a corner the offset is longer (miter), by a factor of 2 at most; where the line turns back it is zero.
  const double miter = before && after ? std::min(2.0, 2 / length) : 1;
  return Eigen::Vector2d(-along.y(), along.x()) / length * half_width * miter;
}

/// Adds the continuous paint from point `first` to `last` as a strip.
void add_strip(::foxglove::TriangleListPrimitive& paint, const marking_line_t& line, std::size_t first,
               std::size_t last) {
  const double half_width = (line.width > 0 ? double{line.width} : kPaintWidth) / 2;
  for (std::size_t i = first; i <= last; ++i) {
    const Eigen::Vector2d side = half_across(line, i, i == first, i == last, half_width);
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector2d corner = Eigen::Vector2d(double{line.x[i]}, double{line.y[i]}) + sign * side;
      set_vector(*paint.add_points(), corner.x(), corner.y(), double{line.z[i]} + kPaintRise);
    }
    if (i == first) continue;
    const auto next = static_cast<std::uint32_t>(paint.points_size());
    for (const std::uint32_t back : {4U, 3U, 2U, 3U, 1U, 2U}) paint.add_indices(next - back);
  }
}

void add_marking(::foxglove::SceneUpdate& scene, const store::MarkingLines::Changes::Added& added, std::int64_t utime) {
  const marking_line_t& line = *added.line;
  auto& entity = add_entity(scene, id_of("marking", added.name), utime);
  auto& paint = *entity.add_triangles();
  set_pose(*paint.mutable_pose(), Pose::Identity());
  set_colour(*paint.mutable_color(), kPaintColour, 1);
  const std::size_t n = line.x.size();
  for (std::size_t first = 0; first + 1 < n; ++first) {
    std::size_t last = first;
    while (last + 1 < n && line.painted[last] != 0) ++last;
    if (last == first) continue;
    add_strip(paint, line, first, last);
    first = last - 1;
  }
  add_metadata(entity, "type", std::string(name_of(line.type)));
  add_metadata(entity, "width", line.width > 0 ? fmt::format("{:.2f} m", line.width) : "unknown");
  if (line.dash > 0) add_metadata(entity, "dash", fmt::format("{:.2f} m", line.dash));
  if (line.gap > 0) add_metadata(entity, "gap", fmt::format("{:.2f} m", line.gap));
  add_metadata(entity, "confidence", fmt::format("{:.2f}", line.confidence));
}

}  // namespace

std::string curbs_message(const store::CurbLines::Changes& changes, std::int64_t utime) {
  ::foxglove::SceneUpdate scene;
  add_deletions(scene, changes, "curb", utime);
  for (const auto& added : changes.added) add_curb(scene, added, utime);
  return scene.SerializeAsString();
}

std::string markings_message(const store::MarkingLines::Changes& changes, std::int64_t utime) {
  ::foxglove::SceneUpdate scene;
  add_deletions(scene, changes, "marking", utime);
  for (const auto& added : changes.added) add_marking(scene, added, utime);
  return scene.SerializeAsString();
}

std::string path_message(const store::ThinnedPath& path, std::size_t first, bool everything, std::int64_t utime) {
  ::foxglove::SceneUpdate scene;
  if (everything) delete_all(scene, utime);
  const auto& points = path.points();
  const std::size_t from =
      everything || first == 0 ? 0 : (first - 1) / kPathPiece;  // a piece ends with the first point of the next one
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
