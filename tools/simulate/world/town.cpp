#include "tools/simulate/world/town.hpp"

#include <cmath>
#include <optional>

#include "tools/simulate/world/car.hpp"
#include "tools/simulate/world/ground_builder.hpp"
#include "tools/simulate/world/place_objects.hpp"
#include "tools/simulate/world/town_plan.hpp"

namespace curbstone::simulate::world {

namespace {

void set_curbs(Street& street, numerics::Random& random) {
  for (const Side side : {Side::kLeft, Side::kRight}) {
    CurbSide& curb = street.curb(side);
    curb.stretch = random.uniform(22.0, 34.0);
    const int n = std::max(1, static_cast<int>(street.length() / curb.stretch));
    for (int i = 0; i < n; ++i) curb.heights.push_back(random.uniform(0.06, 0.15));
  }
}

}  // namespace

Town::Town(const TownOptions& town_options) : options(town_options) {
  const numerics::Random random(options.seed);
  numerics::Random plan = random.fork(1);
  const StreetProfile profile{.steepness = options.steepness};
  TownPlan planned = options.straight > 0 ? plan_straight(options.straight, profile.half_width, plan)
                     : options.loop > 0   ? plan_blocks(options.loop, profile.half_width, plan)
                                          : plan_block(profile.half_width, plan);
  streets = std::move(planned.streets);
  for (auto& street : streets) set_curbs(street, plan);

  const ObjectPlan objects = plan_objects(streets, planned.quarters, random.fork(2));
  for (const auto& drop : objects.driveways)
    streets[drop.street].curb(drop.side).dropped.push_back({drop.s, drop.half, drop.height});
  Ground ground = build_ground(streets, planned.inside, profile, random.fork(3));
  const numerics::Random day = options.day == 0 ? random : random.fork(6).fork(options.day);
  std::optional<numerics::Random> passing;
  if (options.day != 0) passing = day.fork(4);
  std::vector<Shape> shapes = place_objects(objects, streets, planned.quarters, ground, random.fork(4), passing);
  scene = std::make_unique<const Scene>(std::move(ground), std::move(shapes));

  if (options.straight > 0) return;  // moving cars need a loop
  const double around = streets.front().length();
  const int traffic_density = std::max(4, static_cast<int>(around / 110.0));
  numerics::Random traffic = day.fork(5);
  for (int i = 0; i < traffic_density; ++i) {
    cars.push_back({around * (i + traffic.uniform(0.1, 0.9)) / traffic_density, traffic.uniform(6.0, 8.0), 1.45,
                    traffic.uniform(0.15, 0.7)});
  }
}

void Town::place_cars(double t, std::vector<Shape>& shapes) const {
  shapes.clear();
  const Street& loop = streets.front();
  for (const auto& car : cars) {
    const Street::Sample at = loop.at(car.start - car.speed * t);
    const Eigen::Vector2d p = at.point + car.lane * at.normal();
    const auto z = static_cast<double>(scene->ground().height_at(static_cast<float>(p.x()), static_cast<float>(p.y())));
    add_car(shapes, {p.x(), p.y(), z}, std::atan2(-at.tangent.y(), -at.tangent.x()),
            static_cast<float>(car.reflectivity));
  }
}

}  // namespace curbstone::simulate::world
