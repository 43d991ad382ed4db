#include "services/semantic_map/cells/vehicle_outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "common/linear/decompositions.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::cells {

namespace {

constexpr double kMaxLength = 7.0;    // m
constexpr double kMaxWidth = 2.6;     // m
constexpr double kMinLength = 1.2;    // m: one side of a small car seen from behind
constexpr double kMinSide = 0.6;      // m: a side that is shorter has no direction
constexpr double kOnSide = 0.4;       // m: largest distance of a cell from its side: windows lean inwards
constexpr double kMinSideSeen = 0.7;  // share of a side's length along which cells were seen
constexpr double kHalf = 0.5;         // cells: a cell reaches that far from its centre

int turn(const Eigen::Vector2i& a, const Eigen::Vector2i& b, const Eigen::Vector2i& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Convex hull, counter-clockwise (Andrew's monotone chain).
std::vector<Eigen::Vector2i> convex_hull(std::vector<Eigen::Vector2i> cells) {
  std::sort(cells.begin(), cells.end(),
            [](const auto& a, const auto& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); });
  std::vector<Eigen::Vector2i> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t first = hull.size();
    for (const Eigen::Vector2i& at : cells) {
      while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), at) <= 0) hull.pop_back();
      hull.push_back(at);
    }
    hull.pop_back();
    std::reverse(cells.begin(), cells.end());
  }
  return hull;
}

Eigen::Matrix2d principal_axes(const std::vector<Eigen::Vector2i>& cells) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2i& at : cells) mean += at.cast<double>() / static_cast<double>(cells.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2i& at : cells) {
    const Eigen::Vector2d d = at.cast<double>() - mean;
    scatter += d * d.transpose();
  }
  return eigen_pairs<2>(scatter).vectors;
}

}  // namespace

std::optional<VehicleOutline> VehicleOutline::of(const std::vector<Cell>& cells) {
  if (cells.empty()) return std::nullopt;
  const Rectangle extent = bounds(cells, principal_axes(cells));
  const Eigen::Vector2d size = kCellSize * (extent.most - extent.least + Eigen::Vector2d::Ones());
  if (size.maxCoeff() < kMinLength || size.maxCoeff() > kMaxLength || size.minCoeff() > kMaxWidth) return std::nullopt;
  VehicleOutline outline;
  outline.hull_ = convex_hull(cells);
  outline.complete(cells);
  outline.bound();
  return outline;
}

VehicleOutline::Rectangle VehicleOutline::bounds(const std::vector<Cell>& cells, const Eigen::Matrix2d& axes) {
  Rectangle rectangle{axes, Eigen::Vector2d::Constant(1e9), Eigen::Vector2d::Constant(-1e9)};
  for (const Cell& at : cells) {
    const Eigen::Vector2d along = axes.transpose() * at.cast<double>();
    rectangle.least = rectangle.least.cwiseMin(along);
    rectangle.most = rectangle.most.cwiseMax(along);
  }
  return rectangle;
}

/// Takes the better of the two sides along each axis, and of these the worse: the share of its length with seen cells.
double VehicleOutline::sides_seen(const std::vector<Cell>& cells, const Rectangle& rectangle) {
  double worse = 1;
  for (int axis = 0; axis < 2; ++axis) {
    const double length = rectangle.most[axis] - rectangle.least[axis];
    if (kCellSize * length < kMinSide) return 0;
    const auto steps = static_cast<std::size_t>(std::ceil(length));
    std::array<std::vector<bool>, 2> seen{std::vector<bool>(steps), std::vector<bool>(steps)};
    for (const Cell& at : cells) {
      const Eigen::Vector2d along = rectangle.axes.transpose() * at.cast<double>();
      const double across = along[1 - axis];
      const auto step = std::min(static_cast<std::size_t>(along[axis] - rectangle.least[axis]), steps - 1);
      if (kCellSize * (across - rectangle.least[1 - axis]) <= kOnSide) seen[0][step] = true;
      if (kCellSize * (rectangle.most[1 - axis] - across) <= kOnSide) seen[1][step] = true;
    }
    const auto share = [&](const std::vector<bool>& side) {
      return static_cast<double>(std::count(side.begin(), side.end(), true)) / static_cast<double>(steps);
    };
    worse = std::min(worse, std::max(share(seen[0]), share(seen[1])));
  }
  return worse;
}

/// The smallest rectangle along an edge of the hull with two seen sides.
void VehicleOutline::complete(const std::vector<Cell>& cells) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < hull_.size(); ++k) {
    const Eigen::Vector2d edge = (hull_[(k + 1) % hull_.size()] - hull_[k]).cast<double>();
    if (kCellSize * edge.norm() < kMinSide) continue;
    Eigen::Matrix2d axes;
    axes.col(0) = edge.normalized();
    axes.col(1) = Eigen::Vector2d(-axes(1, 0), axes(0, 0));
    const Rectangle rectangle = bounds(cells, axes);
    const double area = (rectangle.most - rectangle.least).prod();
    if (area >= smallest || sides_seen(cells, rectangle) < kMinSideSeen) continue;
    smallest = area;
    rectangle_ = rectangle;
  }
}

void VehicleOutline::bound() {
  least_ = most_ = hull_.front();
  const auto reach = [this](Cell cell) {
    least_ = least_.cwiseMin(cell);
    most_ = most_.cwiseMax(cell);
  };
  for (const Cell& corner : hull_) reach(corner);
  if (!rectangle_) return;
  for (const double x : {rectangle_->least.x() - kHalf, rectangle_->most.x() + kHalf}) {
    for (const double y : {rectangle_->least.y() - kHalf, rectangle_->most.y() + kHalf}) {
      const Eigen::Vector2d corner = rectangle_->axes * Eigen::Vector2d(x, y);
      reach(corner.array().floor().matrix().cast<int>());
      reach(corner.array().ceil().matrix().cast<int>());
    }
  }
}

bool VehicleOutline::contains(Cell cell) const {
  if (rectangle_) {
    const Eigen::Array2d along = (rectangle_->axes.transpose() * cell.cast<double>()).array();
    if ((along >= rectangle_->least.array() - kHalf).all() && (along <= rectangle_->most.array() + kHalf).all())
      return true;
  }
  for (std::size_t k = 0; k < hull_.size(); ++k) {
    if (turn(hull_[k], hull_[(k + 1) % hull_.size()], cell) < 0) return false;
  }
  return hull_.size() > 2 ||
         (cell - hull_.front()).dot(cell - hull_.back()) <= 0;  // of a straight line: between its ends
}

}  // namespace curbstone::semantic_map::cells
