#pragma once

#include <array>
#include <vector>

#include "tools/evaluate/truth/truth.hpp"

namespace curbstone::evaluate {

/// A place in the plane of the truth, m.
struct Place {
  double x = 0;
  double y = 0;
};

/// The true curbs as line segments, and how far a place is from them.
class TrueCurbs {
 public:
  /// Points of one line that follow each other within 0.5 m are joined.
  explicit TrueCurbs(const std::vector<truth::TrueCurbPoint>& points);

  struct Nearest {
    double distance = 1e9;  ///< m, to the nearest curb that counts
    Place place = {};       ///< there
    double dropped = 1e9;   ///< m, to the nearest lowered kerb
  };
  /// Exact within `reach`; beyond, distances stay 1e9.
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

/// Steps are grouped by their height: up to 6, 8, 10, 12 cm, and higher.
inline constexpr std::array kStepBounds = {0.06, 0.08, 0.10, 0.12};  ///< m

struct CurbScore {
  std::array<Score, kTolerances.size()> at;  ///< by tolerance
  int detections = 0;                        ///< curb cells that count
  int on_dropped = 0;                        ///< curb cells nearest to a lowered kerb: neither right nor wrong
  int beyond_truth = 0;                      ///< curb cells where the truth does not know the ground: the same
  int true_points = 0;                       ///< that count; lowered kerbs do not
  std::vector<Place> missed;                 ///< of them, those that were not found at the widest tolerance
  std::vector<Place> wrong;                  ///< detections that are not right at the widest tolerance
  double recall_of_seen = 0;  ///< at the widest tolerance, of the true points where the map is not unknown
  struct Share {
    int points = 0;
    int found = 0;
  };
  std::array<Share, kStepBounds.size() + 1> by_step;  ///< recall at the widest tolerance, by the height of the step

  /// Lowered kerbs, by the lines that are marked so; within the widest tolerance.
  int lowered_points = 0;  ///< true points of lowered kerbs
  int lowered_found = 0;   ///< of them, beside such a line
  int lowered_feet = 0;    ///< points of such lines
  int lowered_wrong = 0;   ///< of them, away from any true lowered kerb

  /// Curbs that nobody saw: the lines that are marked as inferred. Nothing else counts them.
  double inferred_m = 0;      ///< of such lines, where the truth knows the ground
  double inferred_right = 0;  ///< share of it within the widest tolerance of a true curb that is not lowered
  int inferred_found = 0;     ///< true points that are missed, but lie within it of such a line

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
  bool judged = true;  ///< the truth knows the ground about it
};

/// What a map says of curbs, in the truth's frame.
struct CurbMap {
  std::vector<CurbCell> cells;
  std::vector<CurbFoot> feet;       ///< points of the measured curb lines
  std::vector<Place> seen;          ///< centres of all cells that are not unknown
  std::vector<Place> lowered = {};  ///< points of the lines that are marked as lowered
  struct Inferred {
    Place at;
    double length = 0;  ///< m of line that it stands for
    bool judged = true;
  };
  std::vector<Inferred> inferred = {};  ///< points of the lines that are marked as inferred
};

/// Precision: the share of the curb cells that count whose centre is within the tolerance of a true curb. Recall: the
/// share of true curb points that have the centre of a curb cell within the tolerance; also those that nobody could
/// see. Both only within `radius` m of `path`.
[[nodiscard]] CurbScore score_curbs(const CurbMap& map, const std::vector<truth::TrueCurbPoint>& truth,
                                    const std::vector<Place>& path, double radius);

}  // namespace curbstone::evaluate
