#pragma once

#include <cstdint>
#include <optional>
#include <queue>
#include <tuple>
#include <vector>

#include "services/localizer/search/search_region.hpp"

namespace curbstone::localizer::search {

/// Where the vehicle may be.
struct Candidate {
  double x = 0, y = 0, yaw = 0;  ///< of base_link in map; m, rad
  double score = 0;              ///< 0..1: how well what stands about the vehicle falls on what does there
};

/// The whole map searched for the poses from which a plan falls best on what stands upright: branch and bound over
/// shifts, for each of the turns, region by region. It is done in pieces, so that a vehicle may do one a revolution.
/// What comes of it does not depend on the pieces' size. Deterministic; bounded; one thread.
class MapSearch {
 public:
  static constexpr std::size_t kMostPlaces = 140;  ///< of a plan
  static constexpr std::size_t kMostCandidates = 12;

  /// `plan`: m from the vehicle, x along it; within SearchRegion::kSight, at most kMostPlaces. The map outlives this.
  MapSearch(const std::vector<Eigen::Vector2d>& plan, const fields::SavedMap& map);

  /// Goes on until some so many places of the plan were looked up. False: it is done.
  bool go_on(std::int64_t lookups);
  [[nodiscard]] bool done() const { return next_region_ >= regions_.size() && !region_; }
  /// Best first; none is another's neighbour, none scores far less than the best.
  [[nodiscard]] std::vector<Candidate> candidates() const;
  [[nodiscard]] std::int64_t lookups() const { return lookups_; }

 private:
  /// A set of shifts at one turn: (x, y) cells of the region and what follows up to 2^level - 1 further.
  struct Branch {
    int sum, level, turn, x, y;
    [[nodiscard]] auto order() const { return std::tuple(sum, -level, -turn, -y, -x); }
    bool operator<(const Branch& other) const { return order() < other.order(); }
  };

  void enter_next_region();
  void leave_region();
  void push_row();
  void push(int level, int turn, int x, int y);
  void follow(const Branch& branch);
  [[nodiscard]] bool covered(const Branch& branch) const;
  [[nodiscard]] int least() const;

  const fields::SavedMap& map_;
  std::vector<std::vector<std::int32_t>> offsets_;  // cells from the vehicle's, of the plan, by turn
  int full_ = 0;                                    // the sum of a plan that fits everywhere
  std::vector<TileKey> regions_;
  std::size_t next_region_ = 0;
  std::optional<SearchRegion> region_;
  int next_row_ = 0, next_turn_ = 0;  // of the region's coarsest level, not looked at yet
  std::priority_queue<Branch> queue_;
  std::vector<Candidate> here_;   // in this region
  std::vector<Candidate> found_;  // in those before
  double best_ = 0;
  std::int64_t lookups_ = 0, lookups_here_ = 0;
};

}  // namespace curbstone::localizer::search
