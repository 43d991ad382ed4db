#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace curbstone::evaluate::truth {

/// A painted piece of a street: a band `width` m wide around a polyline, cut off square at both ends. Frame: world, m.
struct TrueMarkingPiece {
  std::vector<Eigen::Vector3d> centre;  ///< two points or more
  double width = 0;
};

/// A line with all its dashes, a crossing with all its bars, an arrow with its strokes.
struct TrueMarking {
  enum class Type { kSolid, kDashed, kDouble, kStopLine, kCrossing, kOther };
  Type type = Type::kSolid;
  std::vector<TrueMarkingPiece> pieces;
};

/// Reads markings.csv of a truth folder: line,piece,type,width,x,y,z, one row per vertex, the vertices of a piece in
/// succession. Empty without that file: the true paint is unknown. Throws std::runtime_error with the file, the line
/// and what was expected.
[[nodiscard]] std::vector<TrueMarking> read_markings(const std::string& folder);

}  // namespace curbstone::evaluate::truth
