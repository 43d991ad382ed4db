#pragma once

#include <vector>

#include "tools/simulate/paint/markings.hpp"
#include "tools/simulate/paint/strokes.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate::paint {

enum class Paint { kNone, kFresh, kWorn };

/// How bright a town's ground is: asphalt with patches, tar in its joints and cracks, slabs of pavement, and markings.
/// From the town's seed, by draws of its own: a town's shape is the same with or without. Immutable; safe from any
/// thread.
class PaintedGround {
 public:
  PaintedGround(const world::Town& town, Paint paint);

  /// What is painted on the streets; none of Paint::kNone.
  [[nodiscard]] const std::vector<Marking>& markings() const { return markings_; }
  /// 0..1, of what a beam met: the ground as it is in the beam's spot, other things as the hit says.
  [[nodiscard]] float reflectivity(const world::Ray& ray, const world::Hit& hit) const;
  /// 0..1, of the ground of that kind at a place.
  [[nodiscard]] float at(float x, float y, world::Surface surface) const;

 private:
  std::vector<Marking> markings_;
  Strokes on_road_;
};

}  // namespace curbstone::simulate::paint
