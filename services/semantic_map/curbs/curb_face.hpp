#pragma once

#include <algorithm>

#include "services/semantic_map/curbs/height_step.hpp"

namespace curbstone::semantic_map::curbs {

/// How far a face leans back: least squares of u over height through its points. Beams come in flat, so that of a
/// face's points u is what is noisy. Sums about the means, m^2: those of several faces add up.
struct FaceLean {
  double uz = 0, zz = 0;

  void add(const FaceLean& other, double weight) {
    uz += weight * other.uz;
    zz += weight * other.zz;
  }
  /// m back for each m up; of few points rather upright.
  [[nodiscard]] double slope() const { return std::max(0.0, uz / (zz + kUpright)); }
  bool operator==(const FaceLean&) const = default;

 private:
  // Before any point is seen: upright +- 45 deg, where u is 3 cm off.
  static constexpr double kUpright = 0.001;
};

/// The face of a step: the points between its two sides in height. A kerb's foot lies below its middle, as far towards
/// the low side as the face leans back over half the step.
struct CurbFace {
  double middle = 0;  ///< m in u
  FaceLean lean;
};

/// Of few points it is where the step is, and says nothing of its lean.
[[nodiscard]] CurbFace find_curb_face(const StepWindow& points, const HeightStep& step);

}  // namespace curbstone::semantic_map::curbs
