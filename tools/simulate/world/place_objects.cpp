#include "tools/simulate/world/place_objects.hpp"

#include <cmath>

#include "tools/simulate/world/car.hpp"

namespace curbstone::simulate::world {

namespace {

constexpr double kDrivewayHalf = 1.7;

/// Places objects beside a street, and rejects those that would collide with others.
class ObjectPlacer {
 public:
  ObjectPlacer(const std::vector<Street>& streets, const Quarters& quarters, const Ground& ground,
               numerics::Random random)
      : streets_(streets), quarters_(quarters), ground_(ground), random_(random) {}

  void house(const Plot& plot) {
    const Quarter& quarter = quarters_.at(plot.street, plot.from);
    if (quarter.houses < 1.0 && !random_.chance(quarter.houses)) return;
    const double room = plot.to - plot.from - (plot.driveway ? 3.6 : 1.0);
    const double width = std::min(room, quarter.width.draw(random_)), depth = random_.uniform(7.5, 9.5);
    const double setback = quarter.setback.draw(random_), height = quarter.height.draw(random_);
    const double s = plot.from + 0.5 * room + 0.5;
    const Place at = place(plot.street, plot.side, s, setback + 0.5 * depth);
    const Shape walls = make_box(Surface::kWall, static_cast<float>(random_.uniform(0.3, 0.6)),
                                 {at.x, at.y, at.z + 0.5 * height - 0.7}, {width, depth, height + 1.4}, at.yaw);
    if (!free(walls, 3.2, 0.8)) return;
    shapes_.push_back(walls);
    houses_.push_back(walls);
    // A porch adds relief to the front.
    const Place front = place(plot.street, plot.side, s + random_.uniform(-2.0, 2.0), setback - 0.6);
    shapes_.push_back(make_box(Surface::kWall, 0.45F, {front.x, front.y, front.z + 1.2}, {2.2, 1.3, 2.8}, front.yaw));
  }

  void front(const Plot& plot) {
    const Quarter& quarter = quarters_.at(plot.street, plot.from);
    const double kind = random_.uniform();
    const double end = plot.to - (plot.driveway ? 2.0 * kDrivewayHalf + 0.4 : 0.0);
    const double height = kind < quarter.fences ? random_.uniform(0.65, 0.95) : random_.uniform(1.45, 1.9);
    if (kind > quarter.fences_and_hedges) return;  // open lawn
    const bool fence = kind < quarter.fences;
    for (double s = plot.from + 1.0; s + 1.0 <= end; s += 2.0) {
      const Place at = place(plot.street, plot.side, s, ground_.profile().pavement + (fence ? 0.15 : 0.45));
      const Place next = place(plot.street, plot.side, s + 2.0, ground_.profile().pavement);
      const Place here = place(plot.street, plot.side, s, ground_.profile().pavement);
      const double length = std::hypot(next.x - here.x, next.y - here.y) + 0.04;  // the outside of a bend is longer
      const Shape piece =
          make_box(fence ? Surface::kFence : Surface::kFoliage, fence ? 0.4F : 0.3F,
                   {at.x, at.y, at.z + 0.5 * height - 0.1}, {length, fence ? 0.10 : 0.6, height + 0.2}, at.yaw);
      if (free(piece, ground_.profile().pavement, 0.0)) shapes_.push_back(piece);
    }
  }

  void tree(std::size_t street, Side side, double s, double off) {
    const Place at = place(street, side, s, off);
    const double radius = random_.uniform(0.11, 0.20), crown = random_.uniform(1.7, 2.5),
                 low = random_.uniform(2.6, 3.1);
    const Shape trunk = make_cylinder(Surface::kTrunk, 0.25F, {at.x, at.y, at.z - 0.2}, radius, low + 1.2);
    if (!free(trunk, 0.45, 1.0)) return;
    shapes_.push_back(trunk);
    const double half = random_.uniform(1.2, 1.7);
    shapes_.push_back(make_ellipsoid(Surface::kFoliage, 0.3F, {at.x, at.y, at.z + low + half}, {crown, crown, half}));
  }

  void lamp(std::size_t street, Side side, double s) {
    const Place at = place(street, side, s, 0.42);
    const Shape pole = make_cylinder(Surface::kPole, 0.6F, {at.x, at.y, at.z - 0.2}, 0.07, 5.2);
    if (free(pole, 0.3, 0.5) && !in_driveway(street, side, s, 0.6)) shapes_.push_back(pole);
  }

  void parked_car(std::size_t street, Side side, double s) {
    const double off = -(0.88 + random_.uniform(0.15, 0.35));
    const Place at = place(street, side, s, off);
    if (in_driveway(street, side, s, 2.7)) return;
    for (const double along : {-5.0, 0.0, 5.0}) {  // not at or near a junction
      const Place check = place(street, side, s + along, off);
      if (!ground_.inside(check.x, check.y)) return;
      if (std::abs(static_cast<double>(ground_.at(static_cast<float>(check.x), static_cast<float>(check.y)).distance) -
                   off) > 0.25)
        return;
    }
    add_car(shapes_, {at.x, at.y, at.z}, at.yaw + random_.normal(0.012),
            static_cast<float>(random_.uniform(0.12, 0.7)));
  }

  void bin(std::size_t street, Side side, double s, double off) {
    const double height = off < 0 ? random_.uniform(0.35, 0.55) : random_.uniform(0.85, 0.98);
    const double size = off < 0 ? random_.uniform(0.4, 0.6) : 0.58;
    const Place at = place(street, side, s, off);
    const Shape box = make_box(Surface::kBin, 0.35F, {at.x, at.y, at.z + 0.5 * height - 0.02},
                               {size, 0.62, height + 0.04}, at.yaw + random_.normal(0.15));
    for (const auto& shape : shapes_) {
      if (shape.covers(box.centre.x(), box.centre.y(), 0.5F) && shape.bottom() < box.centre.z() + 1.2F) return;
    }
    if (free(box, off - 0.35, 0.3)) shapes_.push_back(box);
  }

  void set_driveways(const std::vector<Driveway>& driveways) { driveways_ = driveways; }
  void clear_passing() {
    std::erase_if(shapes_, [](const Shape& s) { return s.surface == Surface::kCar || s.surface == Surface::kBin; });
  }
  [[nodiscard]] std::vector<Shape> take() { return std::move(shapes_); }
  numerics::Random& random() { return random_; }

 private:
  struct Place {
    double x, y, z, yaw;
  };

  /// `off` metres behind the foot of the curb (negative: on the road); z on the ground.
  [[nodiscard]] Place place(std::size_t street, Side side, double s, double off) const {
    const Street::Sample at = streets_[street].at(s);
    const double sign = static_cast<int>(side);
    const Eigen::Vector2d p = at.point + sign * (streets_[street].half_width() + off) * at.normal();
    const auto z = static_cast<double>(ground_.height_at(static_cast<float>(p.x()), static_cast<float>(p.y())));
    return {p.x(), p.y(), z, std::atan2(at.tangent.y(), at.tangent.x())};
  }

  /// Whether every corner and edge is `clear` m behind any curb, inside the world, and `apart` m from every house.
  [[nodiscard]] bool free(const Shape& shape, double clear, double apart) const {
    for (int i = -3; i <= 3; ++i) {
      for (int j = -3; j <= 3; ++j) {
        const float lx = shape.half.x() * static_cast<float>(i) / 3.0F,
                    ly = shape.half.y() * static_cast<float>(j) / 3.0F;
        const float x = shape.centre.x() + shape.cos_yaw * lx - shape.sin_yaw * ly;
        const float y = shape.centre.y() + shape.sin_yaw * lx + shape.cos_yaw * ly;
        if (!ground_.inside(static_cast<double>(x), static_cast<double>(y))) return false;
        if (static_cast<double>(ground_.at(x, y).distance) < clear) return false;
        for (const auto& house : houses_) {
          if (house.covers(x, y, static_cast<float>(apart))) return false;
        }
      }
    }
    return true;
  }

  [[nodiscard]] bool in_driveway(std::size_t street, Side side, double s, double margin) const {
    for (const auto& driveway : driveways_) {
      if (driveway.street == street && driveway.side == side && std::abs(driveway.s - s) < driveway.half + margin)
        return true;
    }
    return false;
  }

  const std::vector<Street>& streets_;
  const Quarters& quarters_;
  const Ground& ground_;
  numerics::Random random_;
  std::vector<Driveway> driveways_;
  std::vector<Shape> houses_;
  std::vector<Shape> shapes_;
};

}  // namespace

ObjectPlan plan_objects(const std::vector<Street>& streets, const Quarters& quarters, numerics::Random random) {
  ObjectPlan plan;
  for (std::size_t i = 0; i < streets.size(); ++i) {
    const double begin = streets[i].closed() ? 0.0 : 11.0;
    for (const Side side : {Side::kLeft, Side::kRight}) {
      for (double s = begin + random.uniform(0.0, 2.0); s < streets[i].length() - 12.0;) {
        const double length = quarters.at(i, s).plot.draw(random);
        const Plot plot{i, side, s, std::min(s + length, streets[i].length()), random.chance(0.6)};
        plan.plots.push_back(plot);
        if (plot.driveway)
          plan.driveways.push_back(
              {i, side, plot.to - kDrivewayHalf - 0.2, kDrivewayHalf, random.uniform(0.018, 0.03)});
        s = plot.to;
      }
    }
  }
  return plan;
}

std::vector<Shape> place_objects(const ObjectPlan& plan, const std::vector<Street>& streets, const Quarters& quarters,
                                 const Ground& ground, numerics::Random random,
                                 const std::optional<numerics::Random>& passing) {
  ObjectPlacer placer(streets, quarters, ground, random);
  placer.set_driveways(plan.driveways);
  const auto park = [&](std::size_t i, Side side) {
    numerics::Random& dice = placer.random();
    for (double s = dice.uniform(4.0, 12.0); s < streets[i].length() - 4.0; s += 6.5) {
      if (dice.chance((side == Side::kLeft ? 0.30 : 0.22) * quarters.at(i, s).parking)) placer.parked_car(i, side, s);
    }
  };
  const auto put_bins = [&](std::size_t i, Side side) {
    numerics::Random& dice = placer.random();
    const auto put = [&](double s, double off) {
      if (quarters.at(i, s).lamps_and_bins) placer.bin(i, side, s, off);
    };
    for (double s = dice.uniform(5.0, 25.0); s < streets[i].length(); s += dice.uniform(15.0, 35.0))
      put(s, dice.uniform(0.9, 1.7));
    for (double s = dice.uniform(10.0, 60.0); s < streets[i].length(); s += dice.uniform(50.0, 90.0))
      put(s, -dice.uniform(0.45, 0.7));
  };
  numerics::Random& dice = placer.random();
  for (const auto& plot : plan.plots) placer.house(plot);
  for (const auto& plot : plan.plots) {
    placer.front(plot);
    if (dice.chance(quarters.at(plot.street, plot.from).garden_trees))
      placer.tree(plot.street, plot.side, dice.uniform(plot.from, plot.to), dice.uniform(3.6, 4.6));
  }
  for (std::size_t i = 0; i < streets.size(); ++i) {
    for (const Side side : {Side::kLeft, Side::kRight}) {
      park(i, side);
      for (double s = dice.uniform(2.0, 14.0); s < streets[i].length(); s += quarters.at(i, s).between_trees.draw(dice))
        placer.tree(i, side, s, dice.uniform(0.75, 0.95));
      for (double s = dice.uniform(0.0, 20.0); s < streets[i].length(); s += 28.0) {
        if (quarters.at(i, s).lamps_and_bins) placer.lamp(i, side, s);
      }
      put_bins(i, side);
    }
  }
  if (passing) {  // the permanent objects are drawn as on the first day; now the others are drawn again
    placer.clear_passing();
    dice = *passing;
    for (std::size_t i = 0; i < streets.size(); ++i) {
      for (const Side side : {Side::kLeft, Side::kRight}) {
        park(i, side);
        put_bins(i, side);
      }
    }
  }
  return placer.take();
}

}  // namespace curbstone::simulate::world
