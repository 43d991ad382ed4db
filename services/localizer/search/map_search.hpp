#pragma once

#include <cstdint>
#include <optional>
#include <queue>
#include <tuple>
#include <vector>

#include "services/localizer/search/search_region.hpp"

namespace curbstone::localizer::search {

/// A possible pose of the vehicle.
struct Candidate {
  double x = 0, y = 0, yaw = 0;  ///< of base_link in map; m, rad
  double score = 0;              ///< 0..1: how well the plan falls on the map's upright structures
};

/// Searches the whole map for the poses from which a plan falls best on upright structures: branch and bound over
/// shifts, for each heading, region by region. The search is divided into pieces, so that a vehicle can do one piece a
/// revolution. The result does not depend on the pieces' size. Deterministic; bounded; one thread.
class MapSearch {
 public:
  static constexpr std::size_t kMaxPlaces = 140;  ///< of a plan
  static constexpr std::size_t kMaxCandidates = 12;

  /// `plan`: m from the vehicle, x along it; within SearchRegion::kSight, at most kMaxPlaces. The map must outlive
  /// this object.
  MapSearch(const std::vector<Eigen::Vector2d>& plan, const fields::SavedMap& map);

  /// Continues the search for about `lookups` look-ups of plan positions. Returns false when the search is done.
  bool advance(std::int64_t lookups);
  [[nodiscard]] bool done() const { return next_region_ >= regions_.size() && !region_; }
  /// The candidates, best first. No two are neighbours, and none scores far less than the best.
  [[nodiscard]] std::vector<Candidate> candidates() const;
  [[nodiscard]] std::int64_t lookups() const { return lookups_; }

 private:
  /// A set of shifts at one heading: cells (x, y) of the region to (x, y) + 2^level - 1.
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
  std::vector<std::vector<std::int32_t>> offsets_;  // the plan in cells from the vehicle's cell, by heading
  int full_ = 0;                                    // the sum of a plan that fits everywhere
  std::vector<TileKey> regions_;
  std::size_t next_region_ = 0;
  std::optional<SearchRegion> region_;
  int next_row_ = 0, next_turn_ = 0;  // next of the region's coarsest level to visit
  std::priority_queue<Branch> queue_;
  std::vector<Candidate> here_;   // of this region
  std::vector<Candidate> found_;  // of earlier regions
  double best_ = 0;
  std::int64_t lookups_ = 0, lookups_here_ = 0;
};

}  // namespace curbstone::localizer::search
