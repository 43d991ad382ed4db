#include "tools/simulate/paint/painted_ground.hpp"

#include <algorithm>
#include <cmath>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/paint/plan_markings.hpp"
#include "tools/simulate/paint/speckle.hpp"

namespace curbstone::simulate::paint {

namespace {

using world::Surface;

constexpr std::uint64_t kStream = 7;  // index of the stream; the town itself uses those up to 6
constexpr double kFreshPaint = 0.55F;
constexpr float kHoles = 0.25F;       // share of worn paint
constexpr double kTar = 0.02F;        // bitumen in cracks and joints
constexpr float kSlab = 0.5F;         // m, of the pavement
constexpr float kJoint = 0.015F;      // m, between slabs
constexpr float kHalfBeam = 0.0015F;  // rad, half the beam's divergence

Stroke band(const std::vector<Eigen::Vector2d>& centre, double width, double reflectivity) {
  Stroke stroke{{}, static_cast<float>(width), static_cast<float>(reflectivity), 0.0F};
  for (const Eigen::Vector2d& p : centre) stroke.centre.push_back(p.cast<float>());
  return stroke;
}

/// Adds mended patches with tar around them, cracks across, and a joint along the crown in places.
void add_repairs(const world::Street& street, numerics::Random random, Strokes& strokes) {
  const auto at = [&](double s, double left) -> Eigen::Vector2d {
    const world::Street::Sample sample = street.at(s);
    return sample.point + left * sample.normal();
  };
  const auto along = [&](double from, double to, double left) {
    std::vector<Eigen::Vector2d> line;
    const int n = std::max(1, static_cast<int>((to - from) / 0.5));
    for (int i = 0; i <= n; ++i) line.push_back(at(from + (to - from) * i / n, left));
    return line;
  };
  const double edge = street.half_width() - 0.2;
  for (double s = random.uniform(2.0, 20.0); s < street.length() - 14.0; s += random.uniform(12.0, 45.0)) {
    const double length = random.uniform(1.5, 12.0), width = random.uniform(0.6, 2.6);
    const double middle = random.uniform(-edge + 0.5 * width, edge - 0.5 * width);
    strokes.add(band(along(s, s + length, middle), width, random.uniform(0.09, 0.20)));
    const double seam = random.uniform(0.03, 0.06);
    for (const double side : {-0.5, 0.5}) {
      strokes.add(band(along(s, s + length, middle + side * width), seam, kTar));
      const double end = s + (0.5 + side) * length;
      strokes.add(band({at(end, middle - 0.5 * width), at(end, middle + 0.5 * width)}, seam, kTar));
    }
  }
  for (double s = random.uniform(1.0, 10.0); s < street.length() - 1.0; s += random.uniform(4.0, 22.0)) {
    std::vector<Eigen::Vector2d> crack;
    double forth = 0;
    for (double left = -edge; left <= edge; left += 0.3) {
      crack.push_back(at(s + forth, left));
      forth += random.uniform(-0.12, 0.12);
    }
    strokes.add(band(crack, random.uniform(0.02, 0.05), kTar));
  }
  for (double s = 0; s + 40.0 < street.length(); s += 40.0) {
    const double left = random.uniform(-0.3, 0.3);
    if (random.chance(0.35)) strokes.add(band(along(s, s + 40.0, left), 0.04, kTar));
  }
}

}  // namespace

PaintedGround::PaintedGround(const world::Town& town, Paint paint) {
  const numerics::Random random = numerics::Random(town.options.seed).fork(kStream);
  for (std::size_t i = 0; i < town.streets.size(); ++i) add_repairs(town.streets[i], random.fork(100 + i), on_road_);
  if (paint == Paint::kNone) return;
  markings_ = plan_markings(town, random.fork(1));
  numerics::Random wear = random.fork(2);
  for (const Marking& marking : markings_) {
    const double faded = wear.uniform(0.25, 0.35);  // the pieces of one marking have the same age
    for (const MarkingPiece& piece : marking.pieces) {
      Stroke stroke = band(piece.centre, piece.width, paint == Paint::kFresh ? kFreshPaint : faded);
      if (paint == Paint::kWorn) stroke.holes = kHoles;
      on_road_.add(stroke);
    }
  }
}

float PaintedGround::at(float x, float y, Surface surface) const {
  const float bare = world::ground_reflectivity(surface);
  switch (surface) {
    case Surface::kAsphalt: {
      const float mottled = bare * (0.80F + 0.22F * speckle(x, y, 0.5F, 1) + 0.18F * speckle(x, y, 5.0F, 2));
      return on_road_.reflectivity(x, y, mottled);
    }
    case Surface::kPavement: {
      const float u = x / kSlab, v = y / kSlab;
      const float bu = std::floor(u), bv = std::floor(v);
      if ((u - bu) * kSlab < kJoint || (v - bv) * kSlab < kJoint) return 0.45F * bare;
      return bare * (0.92F + 0.16F * cell_value(static_cast<int>(bu), static_cast<int>(bv), 3));
    }
    case Surface::kGrass:
      return bare * (0.75F + 0.5F * speckle(x, y, 0.3F, 4));
    default:
      return bare;
  }
}

float PaintedGround::reflectivity(const world::Ray& ray, const world::Hit& hit) const {
  if (hit.surface < Surface::kAsphalt || hit.surface > Surface::kGrass) return hit.reflectivity;
  const float x = ray.origin.x() + hit.range * ray.direction.x(), y = ray.origin.y() + hit.range * ray.direction.y();
  if (hit.surface != Surface::kAsphalt || !on_road_.near(x, y)) return at(x, y, hit.surface);
  // The beam's spot, elongated along the ray: at the edge of a marking only a part of it is on paint.
  constexpr int kSpots = 5;
  const float half = kHalfBeam * hit.range / std::max(hit.incidence, 0.05F);
  const float flat = std::hypot(ray.direction.x(), ray.direction.y());
  const float dx = ray.direction.x() / flat, dy = ray.direction.y() / flat;
  float sum = 0;
  for (int i = 0; i < kSpots; ++i) {
    const float off = half * (static_cast<float>(i) - 2.0F) / 2.5F;
    sum += at(x + off * dx, y + off * dy, hit.surface);
  }
  return sum / kSpots;
}

}  // namespace curbstone::simulate::paint
