#pragma once

#include <optional>

#include "services/localizer/search/hypotheses.hpp"
#include "services/localizer/search/local_scan.hpp"
#include "services/localizer/search/map_search.hpp"

namespace curbstone::localizer::search {

/// Finds a vehicle with unknown pose while it drives. It joins some revolutions to a local scan, searches the whole map
/// for it in pieces, one piece a revolution, and tracks the resulting hypotheses until exactly one holds. If none or
/// several hold, it begins again; it then returns no pose. Pure; one thread.
class GlobalLocalizer {
 public:
  explicit GlobalLocalizer(const tracking::TrackingConfig& config) : hypotheses_(config) {}

  /// Takes a revolution. `points`: thinned, in base_link at its end; `motion`: since the previous one. Returns the
  /// vehicle's pose once it is known.
  std::optional<tracking::PoseBelief> process(const std::vector<Eigen::Vector3d>& points, const Pose& T_odom_base,
                                              const tracking::Motion& motion, fields::SavedMap& map);
  /// Begins another search with the next revolution. Call it after a gap in odometry, or when the vehicle's pose is
  /// known.
  void restart();

  /// Several hypotheses have held for some metres.
  [[nodiscard]] bool ambiguous() const { return state_ == State::kDriving && hypotheses_.ambiguous(); }
  /// The best hypothesis; null if there is none yet.
  [[nodiscard]] const Hypothesis* best() const;
  [[nodiscard]] int searches() const { return searches_; }  ///< completed searches of the whole map

 private:
  enum class State { kCollecting, kSearching, kDriving };

  void collect(const std::vector<Eigen::Vector3d>& points, const Pose& T_odom_base, const fields::SavedMap& map);
  void search(const Pose& T_odom_base, fields::SavedMap& map);

  State state_ = State::kCollecting;
  LocalScan scan_;
  std::optional<MapSearch> search_;
  Pose T_odom_anchor_ = Pose::Identity();  // the pose from which the search's plan was taken
  Hypotheses hypotheses_;
  int searches_ = 0;
};

}  // namespace curbstone::localizer::search
