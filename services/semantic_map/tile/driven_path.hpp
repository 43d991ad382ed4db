#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include "common/tiles/tile.hpp"

namespace curbstone::semantic_map::tile {

/// The path that the vehicle drove, m in map. Finds the near part in a time that does not grow with its length.
class DrivenPath {
 public:
  DrivenPath() = default;
  /// In the order of time.
  DrivenPath(std::initializer_list<Eigen::Vector2d> places) : DrivenPath(std::vector<Eigen::Vector2d>(places)) {}
  DrivenPath(const std::vector<Eigen::Vector2d>& places);

  /// Adds a place; `utime`, us, determines its order. Of two with the same time the first is kept.
  void add(std::int64_t utime, const Eigen::Vector2d& place);
  void clear();
  [[nodiscard]] bool empty() const { return places_.empty(); }
  /// The last place. The path must not be empty.
  [[nodiscard]] const Eigen::Vector2d& last() const { return places_.rbegin()->second; }
  /// In the order of time.
  [[nodiscard]] std::vector<Eigen::Vector2d> places() const;

  /// The place nearest to `at`, the earliest of several; nothing if the path is empty.
  [[nodiscard]] std::optional<Eigen::Vector2d> nearest(const Eigen::Vector2d& at) const;
  /// Direction of the motion to the nearest place to `at` that was reached by moving: unit vector. Nothing if that
  /// place is not nearer than `within`, m.
  [[nodiscard]] std::optional<Eigen::Vector2d> direction_near(const Eigen::Vector2d& at, double within) const;

 private:
  /// Calls visit(utime, place) for the places in the squares that are `ring` squares from that of `at`.
  template <class Visit>
  void for_ring(const TileKey& centre, std::int32_t ring, Visit visit) const;

  std::map<std::int64_t, Eigen::Vector2d> places_;                               // by utime
  std::unordered_map<TileKey, std::vector<std::int64_t>, TileKeyHash> squares_;  // utimes of the places in each
};

}  // namespace curbstone::semantic_map::tile
