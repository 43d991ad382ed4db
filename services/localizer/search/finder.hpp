#pragma once

#include <optional>

#include "services/localizer/search/hypotheses.hpp"
#include "services/localizer/search/local_scan.hpp"
#include "services/localizer/search/map_search.hpp"

namespace curbstone::localizer::search {

/// Finds a vehicle of which nothing is known, while it drives: some revolutions are joined, the whole map is searched
/// for where they fit, a piece a revolution, and what the search brings is driven on until one place holds and no other
/// does. When none or several do, it begins again. No answer is an answer. Pure; one thread.
class Finder {
 public:
  explicit Finder(const tracking::TrackingConfig& config) : hypotheses_(config) {}

  /// A revolution: `points` thinned, in base_link at its end; `motion` since the one before. Where the vehicle is, once
  /// that is known.
  std::optional<tracking::PoseBelief> look(const std::vector<Eigen::Vector3d>& points, const Pose& T_odom_base,
                                           const tracking::Motion& motion, fields::SavedMap& map);
  /// Another search begins with the next revolution: after a gap in odometry, or when the vehicle is known.
  void restart();

  /// Several places have held for some metres.
  [[nodiscard]] bool ambiguous() const { return state_ == State::kDriving && hypotheses_.several_hold(); }
  /// The best of what may be; null: nothing yet.
  [[nodiscard]] const Hypothesis* best() const;
  [[nodiscard]] int searches() const { return searches_; }  ///< of the whole map, that came to an end

 private:
  enum class State { kCollecting, kSearching, kDriving };

  void collect(const std::vector<Eigen::Vector3d>& points, const Pose& T_odom_base, const fields::SavedMap& map);
  void search(const Pose& T_odom_base, fields::SavedMap& map);

  State state_ = State::kCollecting;
  LocalScan scan_;
  std::optional<MapSearch> search_;
  Pose T_odom_anchor_ = Pose::Identity();  // from where the search's plan was taken
  Hypotheses hypotheses_;
  int searches_ = 0;
};

}  // namespace curbstone::localizer::search
