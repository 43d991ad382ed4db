#pragma once

#include <vector>

#include "services/localizer/search/map_search.hpp"
#include "services/localizer/tracking/prediction.hpp"

namespace curbstone::localizer::search {

/// A possible pose of the vehicle, tracked from revolution to revolution.
struct Hypothesis {
  tracking::PoseBelief belief;
  tracking::PoseFit fit;     ///< of the last revolution
  double matched_share = 0;  ///< as in PoseFit, averaged over the last revolutions
  double score = 0;  ///< 0..1: what it explains of everything that any hypothesis explains, over the last revolutions
};

/// The poses that a search found, tracked revolution by revolution until exactly one holds. Pure; one thread.
class Hypotheses {
 public:
  explicit Hypotheses(const tracking::TrackingConfig& config) : config_(config) {}

  void begin(std::vector<tracking::PoseBelief> beliefs);
  /// Moves all hypotheses by `motion` and fits each to the revolution. `points`: thinned, in base_link at its end.
  void update(const std::vector<Eigen::Vector3d>& points, const tracking::Motion& motion, fields::SavedMap& map);

  /// The remaining hypotheses, best first.
  [[nodiscard]] const std::vector<Hypothesis>& alive() const { return alive_; }
  [[nodiscard]] double driven() const { return driven_; }  ///< m since begin()
  /// The only remaining hypothesis is the vehicle's pose: it fitted well over some metres, and every other one was
  /// dropped.
  [[nodiscard]] bool converged() const;
  /// Several hypotheses remain after those metres.
  [[nodiscard]] bool ambiguous() const;

 private:
  void weigh();
  void drop();

  tracking::TrackingConfig config_;
  std::vector<Hypothesis> alive_;
  double driven_ = 0;
  int revolutions_ = 0;
};

}  // namespace curbstone::localizer::search
