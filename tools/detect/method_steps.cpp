#include "tools/detect/method_steps.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "services/semantic_map/curbs/curb_evidence.hpp"
#include "services/semantic_map/curbs/curb_filter.hpp"
#include "services/semantic_map/ground/ground_model.hpp"

namespace curbstone::detect {

namespace {

constexpr semantic_map::picture::Colour kNothing{18, 26, 34};
constexpr semantic_map::picture::Colour kGround{96, 100, 104};
constexpr int kMaxPixels = 3000;

/// Dark blue over green to yellow for 0..1.
semantic_map::picture::Colour heat(double share) {
  constexpr semantic_map::picture::Colour kStops[] = {{48, 18, 110}, {30, 110, 150}, {60, 190, 110}, {250, 230, 40}};
  const double at = 3 * std::clamp(share, 0.0, 1.0);
  const int k = std::min(2, static_cast<int>(at));
  return semantic_map::picture::mix(kStops[k], kStops[k + 1], at - k);
}

/// A canvas over a rectangle of the plane.
class Plan {
 public:
  Plan(Eigen::Vector2d low, Eigen::Vector2d high)
      : low_(low),
        scale_(std::min(20.0, kMaxPixels / std::max(1.0, (high - low).maxCoeff()))),
        canvas_(pixels(high.x() - low.x()), pixels(high.y() - low.y()), kNothing) {}

  void square(double x, double y, double edge, semantic_map::picture::Colour colour) {
    const int side = std::max(1, static_cast<int>(std::ceil(edge * scale_)));
    canvas_.fill(column(x - 0.5 * edge), row(y + 0.5 * edge), side, side, colour);
  }
  void tick(const Eigen::Vector2d& at, const Eigen::Vector2d& to, semantic_map::picture::Colour colour) {
    canvas_.line((at.x() - low_.x()) * scale_, canvas_.height() - (at.y() - low_.y()) * scale_,
                 (to.x() - low_.x()) * scale_, canvas_.height() - (to.y() - low_.y()) * scale_, 1.2, colour);
  }
  semantic_map::picture::Canvas take(const std::string& title) {
    canvas_.text(8, 8, title, 2, {255, 255, 255});
    return std::move(canvas_);
  }

 private:
  [[nodiscard]] int pixels(double metres) const { return std::max(1, static_cast<int>(std::ceil(metres * scale_))); }
  [[nodiscard]] int column(double x) const { return static_cast<int>(std::floor((x - low_.x()) * scale_)); }
  [[nodiscard]] int row(double y) const {
    return canvas_.height() - static_cast<int>(std::floor((y - low_.y()) * scale_));
  }
  Eigen::Vector2d low_;
  double scale_;
  semantic_map::picture::Canvas canvas_;
};

template <class T>
semantic_map::tile::Around<T> around(const std::map<TileKey, T>& products, TileKey key) {
  semantic_map::tile::Around<T> result;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const auto it = products.find({key.x + dx, key.y + dy});
      if (it != products.end()) result.set(dx, dy, &it->second);
    }
  }
  return result;
}

/// The products of all steps for all tiles.
struct MethodProducts {
  std::map<TileKey, semantic_map::tile::VotedTile> voted;
  std::map<TileKey, semantic_map::ground::GroundModel> ground;
  std::map<TileKey, std::vector<semantic_map::curbs::CurbCandidate>> evidence;
  std::map<TileKey, std::vector<semantic_map::curbs::CurbPoint>> curbs;
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  Eigen::Vector2d high = Eigen::Vector2d::Constant(kTileSize);
  double bottom = 0;  ///< m, 2 % and 98 % quantiles of the ground's heights
  double top = 1;

  [[nodiscard]] Plan plan() const { return {low, high}; }
};

Eigen::Vector2d corner_of(TileKey key) {
  return {key.x * kTileSize, key.y * kTileSize};
}

MethodProducts run_steps(const std::vector<semantic_map::tile::VotedTile>& tiles,
                         const semantic_map::tile::CurbParameters& parameters, double range) {
  MethodProducts products;
  std::map<TileKey, semantic_map::ground::GroundSamples> samples;
  for (const semantic_map::tile::VotedTile& tile : tiles) {
    const Eigen::Vector2d centre = corner_of(tile.key) + Eigen::Vector2d::Constant(0.5 * kTileSize);
    if (range > 0 && centre.norm() > range) continue;
    products.voted[tile.key] = tile;
    samples[tile.key] = semantic_map::ground::sample_ground(tile, parameters);
  }
  std::vector<double> heights;
  bool first = true;
  for (const auto& [key, tile] : products.voted) {
    products.ground[key] = semantic_map::ground::model_ground(around(samples, key));
    for (const semantic_map::ground::GroundNode& node : products.ground[key].nodes) {
      if (node.valid) heights.push_back(node.plane.height);
    }
    const Eigen::Vector2d corner = corner_of(key);
    products.low = first ? corner : Eigen::Vector2d(products.low.cwiseMin(corner));
    const Eigen::Vector2d end = corner + Eigen::Vector2d::Constant(kTileSize);
    products.high = first ? end : Eigen::Vector2d(products.high.cwiseMax(end));
    first = false;
  }
  std::sort(heights.begin(), heights.end());
  if (!heights.empty()) {
    products.bottom = heights[heights.size() / 50];
    products.top = std::max(products.bottom + 0.1, heights[heights.size() - 1 - heights.size() / 50]);
  }
  for (const auto& [key, tile] : products.voted) {
    products.evidence[key] =
        semantic_map::curbs::find_curb_evidence(
            around(products.voted, key), semantic_map::ground::GroundSurface(around(products.ground, key)), parameters)
            .candidates;
  }
  for (const auto& [key, tile] : products.voted)
    products.curbs[key] = semantic_map::curbs::filter_curbs(around(products.evidence, key), parameters);
  return products;
}

/// Draws value(point, ground), 0..1, of every point.
template <class Value>
semantic_map::picture::Canvas draw_points(const MethodProducts& products, const std::string& title, Value value) {
  Plan plan = products.plan();
  for (const auto& [key, tile] : products.voted) {
    const semantic_map::ground::GroundSurface ground(around(products.ground, key));
    const Eigen::Vector2d corner = corner_of(key);
    for (const semantic_map::tile::VotedPoint& p : tile.points) {
      if (p.mass <= 0) continue;
      plan.square(corner.x() + double{p.x}, corner.y() + double{p.y}, 0.06,
                  heat(value(p, ground.at(double{p.x}, double{p.y}))));
    }
  }
  return plan.take(title);
}

semantic_map::picture::Canvas draw_road_heights(const MethodProducts& products) {
  Plan plan = products.plan();
  constexpr double kCell = kTileSize / semantic_map::ground::GroundModel::kRoadPerSide;
  for (const auto& [key, ground] : products.ground) {
    for (int row = 0; row < semantic_map::ground::GroundModel::kRoadPerSide; ++row) {
      for (int column = 0; column < semantic_map::ground::GroundModel::kRoadPerSide; ++column) {
        const auto height = double{
            ground.road[static_cast<std::size_t>(row * semantic_map::ground::GroundModel::kRoadPerSide + column)]};
        if (std::isnan(height)) continue;
        const Eigen::Vector2d at = corner_of(key) + kCell * Eigen::Vector2d(column + 0.5, row + 0.5);
        plan.square(at.x(), at.y(), kCell, heat((height - products.bottom) / (products.top - products.bottom)));
      }
    }
  }
  return plan.take("road height, 0.5 m");
}

semantic_map::picture::Canvas draw_dem(const MethodProducts& products) {
  Plan plan = products.plan();
  for (const auto& [key, model] : products.ground) {
    const semantic_map::ground::GroundSurface ground(around(products.ground, key));
    for (double y = 0.5 * kCellSize; y < kTileSize; y += kCellSize) {
      for (double x = 0.5 * kCellSize; x < kTileSize; x += kCellSize) {
        const auto height = ground.height(x, y);
        if (!height) continue;
        const Eigen::Vector2d at = corner_of(key) + Eigen::Vector2d(x, y);
        plan.square(at.x(), at.y(), kCellSize, heat((*height - products.bottom) / (products.top - products.bottom)));
      }
    }
  }
  return plan.take("digital elevation map, refined");
}

Eigen::Vector2d place_of(const semantic_map::curbs::CurbCandidate& candidate) {
  return candidate.at;
}
Eigen::Vector2d place_of(const semantic_map::curbs::CurbPoint& point) {
  return point.foot;
}

/// Draws a tick for each step, towards the higher side, coloured by the step's height: yellow is 15 cm.
template <class Candidate>
semantic_map::picture::Canvas draw_steps(const MethodProducts& products,
                                         const std::map<TileKey, std::vector<Candidate>>& steps,
                                         const std::string& title) {
  Plan plan = products.plan();
  for (const auto& [key, tile] : products.voted) {
    for (const semantic_map::tile::VotedPoint& p : tile.points)
      plan.square(corner_of(key).x() + double{p.x}, corner_of(key).y() + double{p.y}, 0.04,
                  semantic_map::picture::mix(kNothing, kGround, 0.5));
  }
  for (const auto& [key, candidates] : steps) {
    for (const Candidate& c : candidates) {
      const Eigen::Vector2d at = corner_of(key) + place_of(c);
      plan.tick(at, at + 0.25 * c.up, heat(c.height / 0.15));
      plan.square(at.x(), at.y(), 0.08,
                  c.weak ? semantic_map::picture::Colour{200, 120, 255} : semantic_map::picture::Colour{90, 255, 90});
    }
  }
  return plan.take(title);
}

}  // namespace

std::vector<StepPicture> draw_method_steps(const std::vector<semantic_map::tile::VotedTile>& tiles,
                                           const cloud_map::CloudMapOptions& options, double range) {
  const MethodProducts products = run_steps(tiles, options.curb, range);
  std::vector<StepPicture> pictures;
  const auto add = [&](const char* name, semantic_map::picture::Canvas canvas) {
    pictures.push_back({name, std::move(canvas)});
  };
  add("1_stick",
      draw_points(products, "stick share, 0 .. 0.5",
                  [](const semantic_map::tile::VotedPoint& p, const auto&) { return 2.0 * double{p.stick}; }));
  add("2_normal",
      draw_points(products, "z of the normal, 0.8 .. 1", [](const semantic_map::tile::VotedPoint& p, const auto&) {
        return (double{p.normal.z()} - 0.8) / 0.2;
      }));
  add("3_road_height", draw_road_heights(products));
  add("4_dem", draw_dem(products));
  add("5_tilt", draw_points(products, "tilt against the ground, 0 .. 0.3",
                            [](const semantic_map::tile::VotedPoint& p, const auto& ground) {
                              if (!ground || double{p.normal.z()} < 0.3) return 0.0;
                              const Eigen::Vector2d slope =
                                  -p.normal.head<2>().template cast<double>() / double{p.normal.z()};
                              return (slope - ground->normal_slope).norm() / 0.3;
                            }));
  add("6_evidence", draw_steps(products, products.evidence, "curb evidence: steps, towards the higher side"));
  add("7_filtered", draw_steps(products, products.curbs, "curbs after the filter"));
  return pictures;
}

}  // namespace curbstone::detect
