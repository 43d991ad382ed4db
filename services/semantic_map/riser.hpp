#pragma once

#include <algorithm>

#include "services/semantic_map/height_step.hpp"

namespace curbstone {

/// How far a riser leans back: least squares of u over height through its points. Beams come in flat, so that of a
/// riser's points u is what is noisy. Sums about the means, m^2: those of several risers add up.
struct RiserLean {
  double uz = 0, zz = 0;

  void add(const RiserLean& other, double weight) {
    uz += weight * other.uz;
    zz += weight * other.zz;
  }
  /// m back for each m up; of few points rather upright.
  [[nodiscard]] double slope() const { return std::max(0.0, uz / (zz + kUpright)); }
  bool operator==(const RiserLean&) const = default;

 private:
  // Before any point is seen: upright +- 45 deg, where u is 3 cm off.
  static constexpr double kUpright = 0.001;
};

/// The face of a step: the points between its two sides in height. A kerb's foot lies below its middle, as far towards
/// the low side as the face leans back over half the step.
struct Riser {
  double middle = 0;  ///< m in u
  RiserLean lean;
};

/// Of few points it is where the step is, and says nothing of its lean.
[[nodiscard]] Riser find_riser(const StepWindow& points, const HeightStep& step);

}  // namespace curbstone
