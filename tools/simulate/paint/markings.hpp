#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace curbstone::simulate::paint {

enum class MarkingType { kSolid, kDashed, kDouble, kStopLine, kCrossing, kOther };

/// As in the type column of markings.csv.
[[nodiscard]] const char* name_of(MarkingType type);

/// A painted piece: a band `width` m wide around a polyline, cut off square at both ends. A dash, a bar of a crossing,
/// a stroke of an arrow, or a whole solid line. Frame: world, plan view, m.
struct MarkingPiece {
  std::vector<Eigen::Vector2d> centre;  ///< two points or more
  double width = 0.12;
};

/// Pieces that belong together: a line with all its dashes, a crossing with all its bars.
struct Marking {
  MarkingType type = MarkingType::kSolid;
  std::vector<MarkingPiece> pieces;
};

}  // namespace curbstone::simulate::paint
