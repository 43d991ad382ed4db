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

/// Where the vehicle drove, m in map. Finds what of it is near in a time that does not grow with its length.
class DrivenPath {
 public:
  DrivenPath() = default;
  /// In the order of time.
  DrivenPath(std::initializer_list<Eigen::Vector2d> places) : DrivenPath(std::vector<Eigen::Vector2d>(places)) {}
  DrivenPath(const std::vector<Eigen::Vector2d>& places);

  /// `utime`, us, is its place in the order of time. Of two of one time the first counts.
  void add(std::int64_t utime, const Eigen::Vector2d& place);
  void clear();
  [[nodiscard]] bool empty() const { return places_.empty(); }
  /// Where it came to at last. Not of an empty path.
  [[nodiscard]] const Eigen::Vector2d& last() const { return places_.rbegin()->second; }
  /// In the order of time.
  [[nodiscard]] std::vector<Eigen::Vector2d> places() const;

  /// Its nearest place to `at`, of several the earliest; nothing of an empty path.
  [[nodiscard]] std::optional<Eigen::Vector2d> nearest(const Eigen::Vector2d& at) const;
  /// Which way it went to its nearest place to `at` to which it moved: unit vector. Nothing if that is not nearer than
  /// `within`, m.
  [[nodiscard]] std::optional<Eigen::Vector2d> direction_near(const Eigen::Vector2d& at, double within) const;

 private:
  /// Calls visit(utime, place) for what lies in the squares that are `ring` squares off that of `at`.
  template <class Visit>
  void for_ring(const TileKey& centre, std::int32_t ring, Visit visit) const;

  std::map<std::int64_t, Eigen::Vector2d> places_;                               // by utime
  std::unordered_map<TileKey, std::vector<std::int64_t>, TileKeyHash> squares_;  // utimes of the places in each
};

}  // namespace curbstone::semantic_map::tile
