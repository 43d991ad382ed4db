#include "tools/simulate/paint/strokes.hpp"

#include <algorithm>
#include <cmath>

#include "tools/simulate/paint/speckle.hpp"

namespace curbstone::simulate::paint {

namespace {

/// Wear in grains and in larger spots: approximately uniform from 0 to 1 over the ground.
float wear(float x, float y) {
  const float grain = speckle(x, y, 0.06F, 11), spot = speckle(x, y, 0.45F, 12);
  return std::clamp(0.5F + 2.5F * (0.55F * grain + 0.45F * spot - 0.5F), 0.0F, 1.0F);
}

}  // namespace

std::int64_t Strokes::key(float x, float y) {
  const auto ix = static_cast<std::int64_t>(std::floor(x / kCell)),
             iy = static_cast<std::int64_t>(std::floor(y / kCell));
  return ix * 0x100000000LL + iy;
}

void Strokes::add(const Stroke& stroke) {
  for (std::size_t i = 0; i + 1 < stroke.centre.size(); ++i) {
    const Eigen::Vector2f a = stroke.centre[i], b = stroke.centre[i + 1];
    const float length = (b - a).norm();
    if (length <= 0) continue;
    const auto index = static_cast<std::uint32_t>(segments_.size());
    segments_.push_back({a, (b - a) / length, length, 0.5F * stroke.width, stroke.reflectivity, stroke.holes});
    const float reach = 0.5F * stroke.width + kMargin;
    const Eigen::Vector2f low = a.cwiseMin(b).array() - reach, high = a.cwiseMax(b).array() + reach;
    for (float x = low.x(); x < high.x() + kCell; x += kCell) {
      for (float y = low.y(); y < high.y() + kCell; y += kCell) {
        const Eigen::Vector2f middle((std::floor(x / kCell) + 0.5F) * kCell, (std::floor(y / kCell) + 0.5F) * kCell);
        const float along = std::clamp((middle - a).dot(segments_.back().along), 0.0F, length);
        if ((a + along * segments_.back().along - middle).norm() > reach + 0.71F * kCell) continue;
        auto& cell = cells_[key(middle.x(), middle.y())];
        if (cell.empty() || cell.back() != index) cell.push_back(index);
      }
    }
  }
}

float Strokes::reflectivity(float x, float y, float bare) const {
  const auto cell = cells_.find(key(x, y));
  if (cell == cells_.end()) return bare;
  for (auto index = cell->second.rbegin(); index != cell->second.rend(); ++index) {
    const Segment& segment = segments_[*index];
    const float dx = x - segment.from.x(), dy = y - segment.from.y();
    const float along = dx * segment.along.x() + dy * segment.along.y();
    if (along < 0 || along > segment.length) continue;
    if (std::abs(segment.along.x() * dy - segment.along.y() * dx) > segment.half_width) continue;
    if (segment.holes > 0 && wear(x, y) < segment.holes) continue;
    return segment.reflectivity;
  }
  return bare;
}

}  // namespace curbstone::simulate::paint
