#pragma once

#include <vector>

#include "tools/simulate/paint/markings.hpp"
#include "tools/simulate/paint/strokes.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate::paint {

enum class Paint { kNone, kFresh, kWorn };

/// The reflectivity of a town's ground: asphalt with patches, tar in its joints and cracks, slabs of pavement, and
/// markings. From the town's seed, with separate draws, so that the town's shape is the same with or without paint.
/// Immutable; safe from any thread.
class PaintedGround {
 public:
  PaintedGround(const world::Town& town, Paint paint);

  /// The markings of the streets; empty for Paint::kNone.
  [[nodiscard]] const std::vector<Marking>& markings() const { return markings_; }
  /// 0..1, of what a beam hit: the ground averaged over the beam's spot, other objects as given by the hit.
  [[nodiscard]] float reflectivity(const world::Ray& ray, const world::Hit& hit) const;
  /// 0..1, of ground of this kind at a place.
  [[nodiscard]] float at(float x, float y, world::Surface surface) const;

 private:
  std::vector<Marking> markings_;
  Strokes on_road_;
};

}  // namespace curbstone::simulate::paint
