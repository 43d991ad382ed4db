#include "services/localizer/tracking/paint_finder.hpp"

#include <cmath>

namespace curbstone::localizer::tracking {
namespace {

constexpr float kUneven = 0.3F;  // m above or below the vehicle's plane
constexpr float kSlope = 0.05F;  // and per metre of distance
constexpr float kBeside = 0.5F;  // m between neighbours on a ring

/// One ring, return by return.
class RingPaint {
 public:
  void add(const Eigen::Vector3f& point, bool is_bright, std::vector<Eigen::Vector3d>& paint) {
    const bool follows = has_last_ && (point - last_).squaredNorm() < kBeside * kBeside;
    if (!follows) piece_.clear();
    const bool begins = piece_.empty();
    if (is_bright && (!begins || (follows && !was_bright_))) piece_.push_back(point);
    if (!is_bright) {
      if (!begins && (piece_.back() - piece_.front()).norm() <= PaintFinder::kLongest) {
        for (const Eigen::Vector3f& p : piece_) paint.emplace_back(p.cast<double>());
      }
      piece_.clear();
    }
    last_ = point;
    was_bright_ = is_bright;
    has_last_ = true;
  }

 private:
  std::vector<Eigen::Vector3f> piece_;  // bright, after one that was not
  Eigen::Vector3f last_ = Eigen::Vector3f::Zero();
  bool has_last_ = false, was_bright_ = false;
};

}  // namespace

std::vector<Eigen::Vector3d> PaintFinder::find(const std::vector<mapper::scan::LidarPoint>& points,
                                               const Pose& T_odom_base) {
  scale_.learn(points, T_odom_base);
  std::vector<RingPaint> rings;
  std::vector<Eigen::Vector3d> paint;
  for (const mapper::scan::LidarPoint& point : points) {
    const Eigen::Vector3f& p = point.position;
    const float away = p.head<2>().cwiseAbs().maxCoeff();
    if (!(away < kReach) || !(std::abs(p.z()) < kUneven + kSlope * away)) continue;
    if (point.ring >= rings.size()) rings.resize(std::size_t{point.ring} + 1);
    rings[point.ring].add(p, scale_.table()->of(point.ring, point.intensity) >= kBright, paint);
  }
  return paint;
}

}  // namespace curbstone::localizer::tracking
