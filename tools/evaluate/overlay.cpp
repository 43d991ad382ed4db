#include "tools/evaluate/overlay.hpp"

#include <cmath>

namespace curbstone::evaluate {

namespace {

constexpr semantic_map::picture::Colour kCurb{255, 0, 200};
constexpr semantic_map::picture::Colour kDropped{255, 170, 235};
constexpr semantic_map::picture::Colour kPath{120, 190, 255};
constexpr semantic_map::picture::Colour kMissedCurb{255, 235, 0};
constexpr semantic_map::picture::Colour kWrongCurb{0, 230, 255};
constexpr semantic_map::picture::Colour kCalledFree{255, 130, 0};
constexpr semantic_map::picture::Colour kCalledBlocked{150, 90, 255};
constexpr double kJoinPoints = 0.5;  // m: points of one curb farther apart are not joined
constexpr double kPathStep = 0.25;   // m

}  // namespace

namespace {

void add_curbs(const truth::Truth& truth, const Pose& T_map_truth, bool dropped,
               std::vector<semantic_map::picture::PictureLine>& lines) {
  const truth::TrueCurbPoint* last = nullptr;
  for (const truth::TrueCurbPoint& point : truth.curbs) {
    if (point.dropped != dropped) {
      last = nullptr;
      continue;
    }
    const Eigen::Vector2d at = (T_map_truth * Eigen::Vector3d(point.x, point.y, point.z)).head<2>();
    const bool goes_on =
        last != nullptr && last->line == point.line && std::hypot(point.x - last->x, point.y - last->y) <= kJoinPoints;
    if (goes_on)
      lines.back().points.push_back(at);
    else
      lines.push_back({{at, at}, dropped ? kDropped : kCurb, 3.0});  // twice, so that a single point is drawn as a dot
    last = &point;
  }
}

}  // namespace

std::vector<semantic_map::picture::PictureLine> truth_lines(const truth::Truth& truth, const Pose& T_truth_map) {
  const Pose T_map_truth = T_truth_map.inverse();
  std::vector<semantic_map::picture::PictureLine> lines;
  add_curbs(truth, T_map_truth, false, lines);
  add_curbs(truth, T_map_truth, true, lines);
  semantic_map::picture::PictureLine path{{}, kPath, 2.0};
  for (const truth::StampedPose& stamped : truth.poses) {
    const Eigen::Vector2d at = (T_map_truth * stamped.pose.translation()).head<2>();
    if (path.points.empty() || (at - path.points.back()).norm() > kPathStep) path.points.push_back(at);
  }
  lines.push_back(std::move(path));
  return lines;
}

std::vector<semantic_map::picture::PictureLine> error_dots(const Evaluation& evaluation) {
  const Pose T_map_truth = evaluation.T_truth_map.inverse();
  std::vector<semantic_map::picture::PictureLine> dots;
  const auto add = [&](const std::vector<Place>& places, semantic_map::picture::Colour colour, double size) {
    for (const Place& place : places) {
      const Eigen::Vector2d at = (T_map_truth * Eigen::Vector3d(place.x, place.y, 0)).head<2>();
      dots.push_back({{at, at}, colour, size});
    }
  };
  if (evaluation.blocking) add(evaluation.blocking->called_blocked, kCalledBlocked, 2.0);
  if (evaluation.curbs) {
    add(evaluation.curbs->missed, kMissedCurb, 4.0);
    add(evaluation.curbs->wrong, kWrongCurb, 4.0);
  }
  if (evaluation.blocking) add(evaluation.blocking->called_free, kCalledFree, 4.0);
  return dots;
}

}  // namespace curbstone::evaluate
