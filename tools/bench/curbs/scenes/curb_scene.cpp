#include "tools/bench/curbs/scenes/curb_scene.hpp"

#include <cmath>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/world/car.hpp"

namespace curbstone::bench::curbs::scenes {

namespace {

constexpr double kBehind = 15.0;  // m of world behind the origin
constexpr double kAhead = 45.0;
constexpr double kAside = 20.0;
constexpr double kHouses = 6.5;  // m behind the curb

/// (s, y) of a point on a road with constant `curvature` from the origin on.
Eigen::Vector2d road_frame(double curvature, double x, double y) {
  if (std::abs(curvature) < 1e-9) return {x, y};
  const double radius = 1 / curvature;
  const double angle = std::atan2(x * (radius > 0 ? 1 : -1), (radius - y) * (radius > 0 ? 1 : -1));
  return {radius * angle, radius - std::copysign(std::hypot(x, radius - y), radius)};
}

Eigen::Vector2d world_frame(double curvature, double s, double y) {
  if (std::abs(curvature) < 1e-9) return {s, y};
  const double radius = 1 / curvature;
  return {(radius - y) * std::sin(s / radius), radius - (radius - y) * std::cos(s / radius)};
}

simulate::world::Ground make_ground(const CurbSceneOptions& o) {
  simulate::world::StreetProfile profile;
  profile.half_width = 0.5 * (o.left + o.right);
  profile.crossfall = o.crossfall;
  profile.pavement = o.pavement;
  profile.ramp = std::min(profile.ramp, o.pavement);
  profile.tufts = o.tufts;
  if (o.height > 0.15) profile.face *= o.height / 0.15;  // bounds the steepness for which rays are cast
  const double reach = std::abs(o.curvature) > 1e-9 ? kAhead : kAside;
  simulate::world::Ground ground(-kBehind, -reach,
                                 static_cast<int>((kBehind + kAhead) / simulate::world::Ground::kPitch) + 1,
                                 static_cast<int>(2 * reach / simulate::world::Ground::kPitch) + 1, profile);
  const double middle = 0.5 * (o.left - o.right);
  for (int iy = 0; iy < ground.height(); ++iy) {
    for (int ix = 0; ix < ground.width(); ++ix) {
      const Eigen::Vector2d at = road_frame(o.curvature, ground.x_of(ix), ground.y_of(iy));
      simulate::world::GroundVertex& node = ground.node(ix, iy);
      node.distance = static_cast<float>(std::abs(at.y() - middle) - profile.half_width);
      node.terrain = static_cast<float>(o.slope * ground.x_of(ix) + o.tilt * ground.y_of(iy));
      node.curb = static_cast<float>(o.height);
      node.pavement = node.curb;
    }
  }
  ground.finish();
  return ground;
}

/// The objects in a scene, placed along the road.
class SceneObjects {
 public:
  SceneObjects(const CurbSceneOptions& options, const simulate::world::Ground& ground, std::uint64_t seed)
      : options_(options), ground_(ground), random_(simulate::numerics::mix_bits(seed ^ 0xca25)) {}

  std::vector<simulate::world::Shape> place() {
    for (const int side : {1, -1}) {
      const double curb = side > 0 ? options_.left : options_.right;
      if (options_.parked_cars) park(side, curb);
      if (options_.hedges) hedge(side, curb);
      build(side, curb);
    }
    return std::move(shapes_);
  }

 private:
  struct Stand {
    Eigen::Vector3d at;
    double yaw;
  };
  [[nodiscard]] Stand stand(double s, double y) const {
    const Eigen::Vector2d at = world_frame(options_.curvature, s, y);
    const auto z = static_cast<double>(ground_.height_at(static_cast<float>(at.x()), static_cast<float>(at.y())));
    return {{at.x(), at.y(), z}, s * options_.curvature};
  }
  void park(int side, double curb) {
    for (double s = -10 + random_.uniform(0, 4); s < 35; s += random_.uniform(6.5, 11)) {
      const Stand car = stand(s, side * (curb - 0.88 - random_.uniform(0.15, 0.35)));
      simulate::world::add_car(shapes_, car.at, car.yaw + random_.normal(0.012),
                               static_cast<float>(random_.uniform(0.12, 0.7)));
    }
  }
  void box_row(simulate::world::Surface surface, int side, double curb, double behind, double height, double depth) {
    for (double s = -14; s < 42; s += 2) {
      const Stand at = stand(s, side * (curb + behind + 0.5 * depth));
      shapes_.push_back(simulate::world::make_box(surface, 0.35F, at.at + Eigen::Vector3d(0, 0, 0.5 * height - 0.2),
                                                  {2.1, depth, height + 0.4}, at.yaw));
    }
  }
  void hedge(int side, double curb) { box_row(simulate::world::Surface::kFoliage, side, curb, 0.5, 1.2, 0.6); }
  void build(int side, double curb) { box_row(simulate::world::Surface::kWall, side, curb, kHouses, 5, 1); }

  const CurbSceneOptions& options_;
  const simulate::world::Ground& ground_;
  simulate::numerics::Random random_;
  std::vector<simulate::world::Shape> shapes_;
};

simulate::world::Scene make_scene(const CurbSceneOptions& options, std::uint64_t seed) {
  simulate::world::Ground ground = make_ground(options);
  std::vector<simulate::world::Shape> shapes = SceneObjects(options, ground, seed).place();
  return {std::move(ground), std::move(shapes)};
}

}  // namespace

std::vector<CurbSceneOptions> peer_scenes() {
  return {{.name = "15 cm, 2 cm noise"},
          {.name = "10 cm", .height = 0.10},
          {.name = "6 cm", .height = 0.06},
          {.name = "15 cm + parked cars", .parked_cars = true},
          {.name = "asymmetric road", .left = 6.5, .right = 2.8},
          {.name = "15 cm, 5 mm noise", .noise = 0.005}};
}

std::vector<CurbSceneOptions> varied_scenes() {
  return {{.name = "4 cm, 1 cm noise", .height = 0.04, .noise = 0.01},
          {.name = "5 cm, 5 mm noise", .height = 0.05, .noise = 0.005},
          {.name = "8 cm, 3 cm noise", .height = 0.08, .noise = 0.03},
          {.name = "20 cm, 3 cm noise", .height = 0.20, .noise = 0.03},
          {.name = "12 cm, tilt 3 %, slope 3 %", .height = 0.12, .tilt = 0.03, .slope = 0.03},
          {.name = "10 cm, crossfall 3 %", .height = 0.10, .noise = 0.01, .crossfall = 0.03},
          {.name = "12 cm, bend of 20 m", .height = 0.12, .curvature = 0.05},
          {.name = "12 cm, hedges", .height = 0.12, .hedges = true},
          {.name = "8 cm, cars, hedges", .height = 0.08, .noise = 0.01, .parked_cars = true, .hedges = true},
          {.name = "8 cm, grass of 6 cm behind it", .height = 0.08, .pavement = 0.15, .tufts = 0.06},
          {.name = "no curb, grass of 3 cm", .height = 0, .pavement = 0.15},
          {.name = "no curb, grass of 6 cm", .height = 0, .pavement = 0.15, .tufts = 0.06},
          {.name = "no curb, parked cars", .height = 0, .parked_cars = true}};
}

CurbScene::CurbScene(const CurbSceneOptions& options, std::uint64_t seed)
    : options_(options), scene_(make_scene(options, seed)) {}

Eigen::Vector3d CurbScene::place(double s, double y) const {
  const Eigen::Vector2d at = world_frame(options_.curvature, s, y);
  return {at.x(), at.y(),
          static_cast<double>(scene_.ground().height_at(static_cast<float>(at.x()), static_cast<float>(at.y())))};
}

Pose CurbScene::T_world_base(double s) const {
  const Eigen::Vector3d ahead = place(s + 0.5, 0) - place(s - 0.5, 0);
  const Eigen::Vector3d left = place(s, 0.4) - place(s, -0.4);
  Pose T = Pose::Identity();
  T.translation() = place(s, 0);
  T.linear().col(0) = ahead.normalized();
  T.linear().col(2) = ahead.cross(left).normalized();
  T.linear().col(1) = T.linear().col(2).cross(T.linear().col(0));
  return T;
}

Eigen::Vector2d CurbScene::along_road(double x, double y) const {
  return road_frame(options_.curvature, x, y);
}

bool CurbScene::sees_curb(const Eigen::Vector3d& from, double s, int side) const {
  const double inside = (side > 0 ? options_.left : options_.right) - 0.05;
  const Eigen::Vector3d at = place(s, side * inside) + Eigen::Vector3d(0, 0, 0.01);
  const Eigen::Vector3d way = at - from;
  const simulate::world::Hit hit = scene_.cast({from.cast<float>(), way.normalized().cast<float>()}, 100.0F, {}, 0);
  return static_cast<double>(hit.range) > way.norm() - 0.15;
}

}  // namespace curbstone::bench::curbs::scenes
