#include "services/localizer/search/local_scan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace curbstone::localizer::search {
namespace {

constexpr double kMinUpright = 0.4;  // m above the lowest point around it,
constexpr double kMaxUpright = 1.9;  // m: the upper limit of the map's classes
constexpr double kSquare = 1.0;      // m, in which the lowest point is taken as ground
constexpr double kThin = 0.5;        // m
constexpr int kMinPoints = 2;        // in a square of kThin

/// A square lattice around the origin.
class SquareLattice {
 public:
  SquareLattice(double reach, double cell) : cell_(cell), half_(static_cast<int>(std::ceil(reach / cell)) + 1) {}
  [[nodiscard]] int side() const { return 2 * half_ + 1; }
  [[nodiscard]] int column(double v) const { return static_cast<int>(std::floor(v / cell_)) + half_; }
  [[nodiscard]] std::size_t index(int x, int y) const { return static_cast<std::size_t>(y * side() + x); }
  [[nodiscard]] std::size_t index(const Eigen::Vector3d& p) const { return index(column(p.x()), column(p.y())); }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(side()) * static_cast<std::size_t>(side()); }

 private:
  double cell_;
  int half_;
};

/// The lowest point of each square and its eight neighbours.
std::vector<double> lowest_about(const std::vector<Eigen::Vector3d>& points, const SquareLattice& lattice) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::vector<double> own(lattice.size(), kNone), all(lattice.size(), kNone);
  for (const Eigen::Vector3d& p : points) own[lattice.index(p)] = std::min(own[lattice.index(p)], p.z());
  for (int y = 1; y + 1 < lattice.side(); ++y) {
    for (int x = 1; x + 1 < lattice.side(); ++x) {
      double& lowest = all[lattice.index(x, y)];
      for (int v = y - 1; v <= y + 1; ++v) {
        for (int u = x - 1; u <= x + 1; ++u) lowest = std::min(lowest, own[lattice.index(u, v)]);
      }
    }
  }
  return all;
}

/// Keeps every n-th place so that at most `most` remain, evenly distributed.
std::vector<Eigen::Vector2d> at_most(std::vector<Eigen::Vector2d> plan, std::size_t most) {
  if (plan.size() <= most) return plan;
  std::vector<Eigen::Vector2d> kept;
  for (std::size_t i = 0; i < most; ++i) kept.push_back(plan[i * plan.size() / most]);
  return kept;
}

}  // namespace

void LocalScan::add(const std::vector<Eigen::Vector3d>& points, const Pose& T_odom_base) {
  if (revolutions_ >= kMaxRevolutions) return;
  if (revolutions_ > 0) driven_ += (T_odom_base.translation() - last_).norm();
  last_ = T_odom_base.translation();
  ++revolutions_;
  for (const Eigen::Vector3d& p : points) points_.push_back(T_odom_base * p);
}

void LocalScan::clear() {
  *this = {};
}

std::vector<Eigen::Vector2d> LocalScan::plan(const Pose& T_odom_base, double reach, std::size_t most) const {
  Pose T_odom_level = T_odom_base;
  T_odom_level.linear() = rotation_from_rpy(0, 0, roll_pitch_yaw(T_odom_base.linear()).z());
  const Pose T_level_odom = T_odom_level.inverse();
  std::vector<Eigen::Vector3d> near;
  for (const Eigen::Vector3d& p : points_) {
    const Eigen::Vector3d q = T_level_odom * p;
    if (q.head<2>().norm() < reach) near.push_back(q);
  }
  const SquareLattice squares(reach, kSquare), thin(reach, kThin);
  const std::vector<double> lowest = lowest_about(near, squares);
  std::vector<int> counts(thin.size());
  std::vector<Eigen::Vector2d> sums(thin.size(), Eigen::Vector2d::Zero());
  for (const Eigen::Vector3d& q : near) {
    const double above = q.z() - lowest[squares.index(q)];
    if (above < kMinUpright || above > kMaxUpright) continue;
    ++counts[thin.index(q)];
    sums[thin.index(q)] += q.head<2>();
  }
  std::vector<Eigen::Vector2d> plan;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] >= kMinPoints) plan.emplace_back(sums[i] / counts[i]);
  }
  return at_most(std::move(plan), most);
}

}  // namespace curbstone::localizer::search
