#pragma once

#include <vector>

#include "services/localizer/search/map_search.hpp"
#include "services/localizer/tracking/prediction.hpp"

namespace curbstone::localizer::search {

/// A place where the vehicle may be, driven on.
struct Hypothesis {
  tracking::PoseBelief belief;
  tracking::PoseFit fit;     ///< of the last revolution
  double matched_share = 0;  ///< as of PoseFit, over the last revolutions
  double score = 0;          ///< 0..1: what it explains of all that any hypothesis explains, over the last revolutions
};

/// What search brought, driven on revolution by revolution until one place holds and no other does. Pure; one thread.
class Hypotheses {
 public:
  explicit Hypotheses(const tracking::TrackingConfig& config) : config_(config) {}

  void begin(std::vector<tracking::PoseBelief> beliefs);
  /// `points`: thinned, in base_link at the revolution's end.
  void drive_on(const std::vector<Eigen::Vector3d>& points, const tracking::Motion& motion, fields::SavedMap& map);

  /// Best first.
  [[nodiscard]] const std::vector<Hypothesis>& alive() const { return alive_; }
  [[nodiscard]] double driven() const { return driven_; }  ///< m since begin()
  /// The first of those alive is where the vehicle is: it fitted well over some metres, and no other came near.
  [[nodiscard]] bool one_holds() const;
  /// Several held over those metres.
  [[nodiscard]] bool several_hold() const;

 private:
  void weigh();
  void drop();

  tracking::TrackingConfig config_;
  std::vector<Hypothesis> alive_;
  double driven_ = 0;
  int revolutions_ = 0;
};

}  // namespace curbstone::localizer::search
