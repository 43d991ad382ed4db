#include "tools/simulate/world/ground_builder.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace curbstone::simulate::world {

namespace {

constexpr double kMargin = 40.0;       // m of ground around the streets
constexpr double kFar = 16.0;          // m; larger distances to a curb are not distinguished
constexpr double kCornerRadius = 6.0;  // m, of the curb where streets meet

/// Rolling ground: a few long waves, together at most `steepness` steep.
class Terrain {
 public:
  Terrain(double steepness, numerics::Random random) {
    for (auto& wave : waves_) {
      const double length = random.uniform(90.0, 190.0), heading = random.uniform(0.0, 2.0 * std::numbers::pi);
      wave.k = Eigen::Vector2d(std::cos(heading), std::sin(heading)) * (2.0 * std::numbers::pi / length);
      wave.phase = random.uniform(0.0, 2.0 * std::numbers::pi);
      wave.amplitude = steepness * 0.3125 * length / (2.0 * std::numbers::pi);
    }
  }
  [[nodiscard]] double at(const Eigen::Vector2d& p) const {
    double z = 0;
    for (const auto& wave : waves_) z += wave.amplitude * std::sin(wave.k.dot(p) + wave.phase);
    return z;
  }

 private:
  struct Wave {
    Eigen::Vector2d k;
    double phase = 0, amplitude = 0;
  };
  std::array<Wave, 3> waves_;
};

/// Distance of every node to one street's edge, and the place along that edge.
struct StreetField {
  std::vector<float> distance;  // first the squared distance to the crown, then the signed distance to the edge
  std::vector<float> s;
  std::vector<std::int8_t> side;
};

StreetField measure(const Street& street, const Ground& ground) {
  const auto nodes = static_cast<std::size_t>(ground.width()) * static_cast<std::size_t>(ground.height());
  StreetField field{std::vector<float>(nodes, 1e9F), std::vector<float>(nodes, 0.0F),
                    std::vector<std::int8_t>(nodes, 1)};
  const double reach = kFar + street.half_width() + 1.0;
  const auto& samples = street.samples();
  const std::size_t segments = street.closed() ? samples.size() : samples.size() - 1;
  const auto first_node = [](double lo, double origin) {
    return std::max(0, static_cast<int>((lo - origin) / Ground::kPitch));
  };
  for (std::size_t i = 0; i < segments; ++i) {
    const Eigen::Vector2d a = samples[i].point, b = samples[(i + 1) % samples.size()].point;
    const Eigen::Vector2d ab = b - a;
    const double length = ab.norm(), inverse = 1.0 / ab.squaredNorm();
    const int x_begin = first_node(std::min(a.x(), b.x()) - reach, ground.x_of(0));
    const int y_begin = first_node(std::min(a.y(), b.y()) - reach, ground.y_of(0));
    const int x_end = std::min(ground.width() - 1, first_node(std::max(a.x(), b.x()) + reach, ground.x_of(0)));
    const int y_end = std::min(ground.height() - 1, first_node(std::max(a.y(), b.y()) + reach, ground.y_of(0)));
    for (int iy = y_begin; iy <= y_end; ++iy) {
      for (int ix = x_begin; ix <= x_end; ++ix) {
        const Eigen::Vector2d ap(ground.x_of(ix) - a.x(), ground.y_of(iy) - a.y());
        const double f = std::clamp(ap.dot(ab) * inverse, 0.0, 1.0);
        const auto squared = static_cast<float>((ap - f * ab).squaredNorm());
        const auto k =
            static_cast<std::size_t>(iy) * static_cast<std::size_t>(ground.width()) + static_cast<std::size_t>(ix);
        if (squared >= field.distance[k]) continue;
        field.distance[k] = squared;
        field.s[k] = static_cast<float>(samples[i].s + f * length);
        field.side[k] = ab.x() * ap.y() - ab.y() * ap.x() >= 0 ? 1 : -1;
      }
    }
  }
  for (auto& d : field.distance)
    d = std::min(static_cast<float>(kFar), std::sqrt(d) - static_cast<float>(street.half_width()));
  return field;
}

/// Union of two areas by their signed distances, with rounded inner corners (exact for streets at right angles).
double join(double a, double b) {
  const double u = std::max(kCornerRadius - a, 0.0), v = std::max(kCornerRadius - b, 0.0);
  return std::max(kCornerRadius, std::min(a, b)) - std::hypot(u, v);
}

/// Flat ground with a margin around the first `inside` streets.
Ground flat_ground(const std::vector<Street>& streets, std::size_t inside, const StreetProfile& profile) {
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (std::size_t i = 0; i < inside; ++i) {
    for (const auto& sample : streets[i].samples()) {
      low = low.cwiseMin(sample.point);
      high = high.cwiseMax(sample.point);
    }
  }
  low.array() -= kMargin;
  high.array() += kMargin;
  return {low.x(), low.y(), static_cast<int>((high.x() - low.x()) / Ground::kPitch) + 1,
          static_cast<int>((high.y() - low.y()) / Ground::kPitch) + 1, profile};
}

/// What several streets make of a node together.
struct Blend {
  double distance = kFar, weights = 0, curb = 0, pavement = 0;
};

void add(const Street& street, const StreetField& field, bool is_first, std::vector<Blend>& blends) {
  for (std::size_t k = 0; k < blends.size(); ++k) {
    Blend& blend = blends[k];
    const auto own = static_cast<double>(field.distance[k]);
    if (own >= kFar) continue;
    blend.distance = is_first ? own : join(blend.distance, own);
    const Side side = field.side[k] > 0 ? Side::kLeft : Side::kRight;
    const auto s = static_cast<double>(field.s[k]);
    // Blends the curbs of two streets around a corner.
    const double weight = 1.0 / ((0.2 + std::abs(own)) * (0.2 + std::abs(own)));
    blend.weights += weight;
    blend.curb += weight * street.curb(side).height(s, street.length(), street.closed());
    blend.pavement += weight * street.curb(side).full_height(s, street.length(), street.closed());
  }
}

void shape(Ground& ground, const Terrain& terrain, const std::vector<Blend>& blends) {
  std::size_t k = 0;
  for (int iy = 0; iy < ground.height(); ++iy) {
    for (int ix = 0; ix < ground.width(); ++ix, ++k) {
      const Blend& blend = blends[k];
      GroundVertex& node = ground.node(ix, iy);
      node.distance = static_cast<float>(std::min(blend.distance, kFar));
      node.terrain = static_cast<float>(terrain.at({ground.x_of(ix), ground.y_of(iy)}));
      if (blend.weights > 0) {
        node.curb = static_cast<float>(blend.curb / blend.weights);
        node.pavement = static_cast<float>(blend.pavement / blend.weights);
      }
    }
  }
  ground.finish();
}

}  // namespace

Ground build_ground(const std::vector<Street>& streets, std::size_t inside, const StreetProfile& profile,
                    numerics::Random random) {
  const Terrain terrain(profile.steepness, random.fork(1));
  Ground ground = flat_ground(streets, inside, profile);
  // Street by street, because all fields of a large town do not fit in memory.
  std::vector<Blend> blends(static_cast<std::size_t>(ground.width()) * static_cast<std::size_t>(ground.height()));
  for (std::size_t i = 0; i < streets.size(); ++i) add(streets[i], measure(streets[i], ground), i == 0, blends);
  shape(ground, terrain, blends);
  return ground;
}

}  // namespace curbstone::simulate::world
