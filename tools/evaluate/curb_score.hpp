#pragma once

#include <array>
#include <vector>

#include "tools/evaluate/truth/truth.hpp"

namespace curbstone::evaluate {

/// A point in the plane of the truth, m.
struct Place {
  double x = 0;
  double y = 0;
};

/// The true curbs as line segments, for the distance of a point to them.
class TrueCurbs {
 public:
  /// Consecutive points of a line within 0.5 m are joined.
  explicit TrueCurbs(const std::vector<truth::TrueCurbPoint>& points);

  struct Nearest {
    double distance = 1e9;  ///< m, to the nearest curb that is not lowered
    Place place = {};       ///< the nearest point on that curb
    double dropped = 1e9;   ///< m, to the nearest lowered curb
  };
  /// Exact within `reach`; distances beyond it stay 1e9.
  [[nodiscard]] Nearest nearest(Place place, double reach) const;

 private:
  struct Segment {
    Place a, b;
    bool dropped;
  };
  std::vector<std::vector<Segment>> buckets_;
  double min_x_ = 0, min_y_ = 0;
  int columns_ = 0, rows_ = 0;
};

inline constexpr std::array kTolerances = {0.12, 0.15, 0.24};  ///< m

struct Score {
  double precision = 0;
  double recall = 0;
  [[nodiscard]] double f1() const { return precision + recall > 0 ? 2 * precision * recall / (precision + recall) : 0; }
};

/// Steps are grouped by height: up to 6, 8, 10, 12 cm, and higher.
inline constexpr std::array kStepBounds = {0.06, 0.08, 0.10, 0.12};  ///< m

struct CurbScore {
  std::array<Score, kTolerances.size()> at;  ///< by tolerance
  int detections = 0;                        ///< curb cells that are scored
  int on_dropped = 0;                        ///< curb cells nearest to a lowered curb: neither right nor wrong
  int beyond_truth = 0;                      ///< curb cells where the true ground is unknown: likewise
  int true_points = 0;                       ///< true points that are scored; lowered curbs are not
  std::vector<Place> missed;                 ///< of these, not found at the widest tolerance
  std::vector<Place> wrong;                  ///< detections not right at the widest tolerance
  double recall_of_seen = 0;                 ///< at the widest tolerance, over the true points where something was seen
  struct Share {
    int points = 0;
    int found = 0;
  };
  std::array<Share, kStepBounds.size() + 1> by_step;  ///< recall at the widest tolerance, by the height of the step

  /// Lowered curbs, by the lines marked as lowered; within the widest tolerance.
  int lowered_points = 0;  ///< true points of lowered curbs
  int lowered_found = 0;   ///< of these, near such a line
  int lowered_feet = 0;    ///< points of such lines
  int lowered_wrong = 0;   ///< of these, away from any true lowered curb

  /// Inferred curbs, by the lines marked as inferred. No other score includes them.
  double inferred_m = 0;      ///< m of such lines where the true ground is known
  double inferred_right = 0;  ///< share of it within the widest tolerance of a true curb that is not lowered
  int inferred_found = 0;     ///< true points that are missed, but within that tolerance of such a line

  // Of the points of measured curb lines within 0.5 m of a true curb:
  double lateral_median_cm = 0;  ///< distance of the foot from the true one
  double lateral_p95_cm = 0;
  double lateral_bias_cm = 0;    ///< median offset, positive towards the higher side
  double lateral_spread_cm = 0;  ///< 1.48 * median deviation from the bias: 1 sigma where errors are normal
};

/// A point of a mapped curb line, and the unit vector towards the higher side.
struct CurbFoot {
  Place at;
  Place up;
};

/// The centre of a cell of class curb.
struct CurbCell {
  Place at;
  bool judged = true;  ///< the true ground around it is known
};

/// The curbs of a map, in the truth's frame.
struct CurbMap {
  std::vector<CurbCell> cells;
  std::vector<CurbFoot> feet;       ///< points of the measured curb lines
  std::vector<Place> seen;          ///< centres of all cells in which something was seen
  std::vector<Place> lowered = {};  ///< points of the lines marked as lowered
  struct Inferred {
    Place at;
    double length = 0;  ///< m of line that the point represents
    bool judged = true;
  };
  std::vector<Inferred> inferred = {};  ///< points of the lines marked as inferred
};

/// Precision: the share of the scored curb cells whose centre is within the tolerance of a true curb. Recall: the share
/// of true curb points with the centre of a curb cell within the tolerance, including those that were never visible.
/// Both only within `radius` m of `path`.
[[nodiscard]] CurbScore score_curbs(const CurbMap& map, const std::vector<truth::TrueCurbPoint>& truth,
                                    const std::vector<Place>& path, double radius);

}  // namespace curbstone::evaluate
