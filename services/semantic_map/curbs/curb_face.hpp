#pragma once

#include <algorithm>

#include "services/semantic_map/curbs/height_step.hpp"

namespace curbstone::semantic_map::curbs {

/// How far a face leans back: least squares of u over height through its points, because beams are nearly horizontal
/// and so the noise of a face's points is in u. Sums about the means, m^2, which can be added over several faces.
struct FaceLean {
  double uz = 0, zz = 0;

  void add(const FaceLean& other, double weight) {
    uz += weight * other.uz;
    zz += weight * other.zz;
  }
  /// m back for each m up; nearly upright if there are few points.
  [[nodiscard]] double slope() const { return std::max(0.0, uz / (zz + kUpright)); }
  bool operator==(const FaceLean&) const = default;

 private:
  // Prior: upright +- 45 deg, with points that are 3 cm off in u.
  static constexpr double kUpright = 0.001;
};

/// The face of a step: the points between its two sides in height. The foot of a kerb lies in front of the middle of
/// its face, by half the height times the lean.
struct CurbFace {
  double middle = 0;  ///< m in u
  FaceLean lean;
};

/// The face of a step. With few points its middle is the place of the step, and its lean is unknown.
[[nodiscard]] CurbFace find_curb_face(const StepWindow& points, const HeightStep& step);

}  // namespace curbstone::semantic_map::curbs
