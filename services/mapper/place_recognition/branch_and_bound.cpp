#include "services/mapper/place_recognition/branch_and_bound.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>
#include <tuple>

namespace curbstone::mapper::place_recognition {
namespace {

constexpr double kSight = 40.0;         // m: farther points are few, and displaced by much for a small turn
constexpr double kThin = 0.3;           // m: one point of the scan counts per square of this size
constexpr double kTurnStep = 0.014;     // rad: half of it moves a point at 30 m by 0.2 m
constexpr double kMatchesApart = 1.5;   // m, between distinct poses
constexpr double kMatchesTurned = 0.1;  // rad
constexpr double kMinLikelihood = 0.5;  // score: at its true pose every scan scores more
constexpr double kBehind = 0.35;        // score: a pose this far behind the best is no rival
// Bounds the time, as points looked up on the map. A place that is found takes less than half of it, except for the
// widest searches, where it may take 385 of 470 million (bench_places).
constexpr double kLookups = 2e7;
constexpr double kLookupsPerTurn = 1e6;

/// A set of shifts at one turn: the (x, y) cells and those up to 2^level - 1 further on.
struct Branch {
  int sum;
  int level;
  int turn, x, y;
  [[nodiscard]] auto order() const { return std::tuple(sum, -level, -turn, -y, -x); }
  bool operator<(const Branch& other) const { return order() < other.order(); }
};

std::vector<Eigen::Vector2d> thinned_plan(const std::vector<Eigen::Vector3f>& points) {
  constexpr int kHalf = static_cast<int>(kSight / kThin) + 1;
  constexpr int kSide = 2 * kHalf + 1;
  std::vector<bool> taken(static_cast<std::size_t>(kSide * kSide), false);
  std::vector<Eigen::Vector2d> out;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector2d q = p.head<2>().cast<double>();
    if (!(q.norm() < kSight)) continue;
    const int x = static_cast<int>(std::floor(q.x() / kThin)) + kHalf,
              y = static_cast<int>(std::floor(q.y() / kThin)) + kHalf;
    const auto cell = static_cast<std::size_t>(y * kSide + x);
    if (taken[cell]) continue;
    taken[cell] = true;
    out.push_back(q);
  }
  return out;
}

class BranchAndBound {
 public:
  BranchAndBound(const PrecomputationGrids& map, const std::vector<Eigen::Vector2d>& points, const SearchWindow& range)
      : map_(map),
        range_(range),
        shifts_(static_cast<int>(std::ceil(range.reach / PrecomputationGrids::kCell))),
        full_(255.0 * static_cast<double>(points.size())),
        least_(static_cast<int>(kMinLikelihood * full_)) {
    const int turns = static_cast<int>(std::ceil(std::min(range.turn, std::numbers::pi) / kTurnStep));
    step_ = turns > 0 ? std::min(range.turn, std::numbers::pi) / turns : 0;
    for (int i = -turns; i <= turns; ++i) {
      if (i == turns && turns > 0 && range.turn >= std::numbers::pi) break;  // is -turns
      yaws_.push_back(range.yaw + i * step_);
      const Eigen::Rotation2Dd turn(yaws_.back());
      std::vector<int> cells;
      for (const Eigen::Vector2d& p : points) {
        const Eigen::Vector2d q = turn * p;
        cells.push_back(map.cell(q.y()) * map.side() + map.cell(q.x()));
      }
      cells_.push_back(std::move(cells));
    }
    const double lookups = kLookups + kLookupsPerTurn * static_cast<double>(yaws_.size());
    most_branches_ = static_cast<int>(lookups / static_cast<double>(points.size()));
  }

  [[nodiscard]] std::vector<PlanarPose> best(int most) {
    constexpr int kTop = PrecomputationGrids::kLevels - 1;
    for (int turn = 0; turn < static_cast<int>(yaws_.size()); ++turn) {
      for (int y = -shifts_; y <= shifts_; y += 1 << kTop) {
        for (int x = -shifts_; x <= shifts_; x += 1 << kTop) push(kTop, turn, x, y);
      }
    }
    std::vector<PlanarPose> found;
    while (!queue_.empty() && static_cast<int>(found.size()) < most && branches_ < most_branches_) {
      const Branch branch = queue_.top();
      queue_.pop();
      if (branch.sum < least_) break;  // the queue is sorted: all others are worse
      if (covered(branch, found)) continue;
      if (branch.level == 0) {
        if (found.empty()) least_ = std::max(least_, branch.sum - static_cast<int>(kBehind * full_));
        const Eigen::Vector2d at = shift(branch.x, branch.y);
        found.push_back({at.x(), at.y(), yaws_[static_cast<std::size_t>(branch.turn)], branch.sum / full_});
        continue;
      }
      const int half = 1 << (branch.level - 1);
      for (const int y : {branch.y, branch.y + half}) {
        for (const int x : {branch.x, branch.x + half}) push(branch.level - 1, branch.turn, x, y);
      }
    }
    return found;
  }

 private:
  static Eigen::Vector2d shift(int x, int y) { return PrecomputationGrids::kCell * Eigen::Vector2d(x, y); }

  void push(int level, int turn, int x, int y) {
    if (x > shifts_ || y > shifts_) return;
    ++branches_;
    const std::uint8_t* values = map_.level(level).data() + (y * map_.side() + x);
    int sum = 0;
    for (const int cell : cells_[static_cast<std::size_t>(turn)]) sum += values[cell];
    if (sum < least_) return;
    queue_.push({sum, level, turn, x, y});
  }

  /// Whether every pose that the branch may lead to is a neighbour of one found.
  [[nodiscard]] bool covered(const Branch& branch, const std::vector<PlanarPose>& found) const {
    const int last = (1 << branch.level) - 1;
    return std::any_of(found.begin(), found.end(), [&](const PlanarPose& pose) {
      const Eigen::Vector2d at(pose.x, pose.y);
      const Eigen::Vector2d low = shift(branch.x, branch.y) - at, high = shift(branch.x + last, branch.y + last) - at;
      const double yaw = std::remainder(yaws_[static_cast<std::size_t>(branch.turn)] - pose.yaw, 2 * std::numbers::pi);
      return low.cwiseAbs().cwiseMax(high.cwiseAbs()).norm() < kMatchesApart && std::abs(yaw) < kMatchesTurned;
    });
  }

  const PrecomputationGrids& map_;
  SearchWindow range_;
  int shifts_;
  double full_;  // the sum of a scan that matches everywhere
  int least_;    // the least sum worth following
  double step_ = 0;
  std::vector<double> yaws_;
  std::vector<std::vector<int>> cells_;  // of the points, by turn
  std::priority_queue<Branch> queue_;
  int most_branches_ = 0;
  int branches_ = 0;
};

}  // namespace

double lattice_reach(double search_reach) {
  return kSight + search_reach + PrecomputationGrids::kCell * (1 << PrecomputationGrids::kLevels);
}

std::vector<PlanarPose> branch_and_bound(const PrecomputationGrids& map, const std::vector<Eigen::Vector3f>& points,
                                         const SearchWindow& range, int most) {
  const std::vector<Eigen::Vector2d> scan = thinned_plan(points);
  const bool fits = 2 * std::ceil(lattice_reach(range.reach) / PrecomputationGrids::kCell) < map.side();
  if (scan.empty() || !fits || !(range.turn >= 0)) return {};
  return BranchAndBound(map, scan, range).best(most);
}

}  // namespace curbstone::mapper::place_recognition
