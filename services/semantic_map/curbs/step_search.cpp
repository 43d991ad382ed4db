#include "services/semantic_map/curbs/step_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "services/semantic_map/tile/vectorised.hpp"

namespace curbstone::semantic_map::curbs {

namespace {

constexpr std::size_t kEnoughPoints = 100;  // in the short window
constexpr int kMaxFacePoints = 3;           // on the step and above it: more belong to a wall
constexpr double kSearch = 0.24;            // m: how far the found step may be from the place
constexpr double kSameDirection = 0.97;     // cosine: less than the turns between two directions

/// From .. to, m; empty where to < from.
struct Interval {
  double from, to;
};

/// The strip between two parallel lines: |a x + b y| <= most.
class Band {
 public:
  Band(double a, double b, double most) : b_(b), most_(most), inverse_a_(std::abs(a) < 1e-2 ? 0 : 1 / a) {}
  /// The part of interval x in which the strip contains a point with a y in interval y.
  [[nodiscard]] Interval cut(const Interval& x, const Interval& y) const {
    if (inverse_a_ == 0) return x;
    const double p = (-most_ - std::max(b_ * y.from, b_ * y.to)) * inverse_a_;
    const double q = (most_ - std::min(b_ * y.from, b_ * y.to)) * inverse_a_;
    return {std::max(x.from, std::min(p, q)), std::min(x.to, std::max(p, q))};
  }

 private:
  double b_, most_, inverse_a_;
};
constexpr std::size_t kMaxRows = NearGroundPoints::kSide;
constexpr double kRounding = 1e-4;  // m by which rounding may make an interval too small

/// The window in which a step is sought: a rectangle around a cell, `up` across the step.
struct StepRectangle {
  Eigen::Vector2d at;
  Eigen::Vector2d up;
  double half_width;   ///< m along `up`
  double half_length;  ///< m
};

/// Consecutive points, and their place in the window.
struct Run {
  std::size_t from, to, size;
};

/// Transforms points to the frame of the window, eight at a time. Those taken beyond the end of a run are overwritten
/// by the next run, or lie beyond the end of the window.
CURBSTONE_VECTORISED
void turn_points(const double* x, const double* y, const double* z, const double* unfit, const Run* runs,
                 std::size_t num_runs, const StepRectangle& r, double* __restrict u, double* __restrict t,
                 double* __restrict up, double* __restrict carries) {
  const double at_x = r.at.x();
  const double at_y = r.at.y();
  const double up_x = r.up.x();
  const double up_y = r.up.y();
  for (std::size_t k = 0; k < num_runs; ++k) {
    const Run run = runs[k];
    for (std::size_t begin = 0; begin < run.size; begin += NearGroundPoints::kPadding) {
      for (std::size_t i = begin; i < begin + NearGroundPoints::kPadding; ++i) {
        const double dx = x[run.from + i] - at_x;
        const double dy = y[run.from + i] - at_y;
        u[run.to + i] = dx * up_x + dy * up_y;
        t[run.to + i] = dx * -up_y + dy * up_x;
        up[run.to + i] = z[run.from + i];
        carries[run.to + i] = unfit[run.from + i];
      }
    }
  }
}

std::size_t count_points(const StepWindow& window) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < window.size(); ++i) n += window.has(i) ? 1U : 0U;
  return n;
}

/// The height of a step in units of its threshold, which follows from its uncertainty and the noise around: 1 and more
/// is a step, if separates_sides().
double certainty(const HeightStep& step, double noise, const tile::CurbParameters& parameters) {
  const double sigma = step.sigma * std::max(1.0, noise / step.roughness);
  return step.height /
         std::max({parameters.min_weak_step, parameters.step_sigmas * sigma, parameters.layer_sigmas * noise});
}

/// Whether a step separates the heights of its two sides, and is not the foot of a wall.
bool separates_sides(const StepSides& sides, const HeightStep& step, const tile::CurbParameters& parameters) {
  return sides.face_above <= kMaxFacePoints && sides.clear >= parameters.clear_share * step.height;
}

bool is_more_certain(const HeightStep& a, const HeightStep& b) {
  return a.height * b.sigma > b.height * a.sigma;
}

}  // namespace

/// Fills the window with the points of the rectangle; with kLengthwise also with those beyond its two sides. Others
/// around it may be among them: they are too far along to count (StepWindow::has()).
void StepSearch::fill_window(const Eigen::Vector2d& up, double half_length, Trim trim) {
  const StepRectangle r{at_, up, parameters_.half_window + kSearch, half_length};
  const Eigen::Vector2d along(-r.up.y(), r.up.x());
  const double extent_x = std::abs(r.up.x()) * r.half_width + std::abs(along.x()) * r.half_length;
  const double extent_y = std::abs(r.up.y()) * r.half_width + std::abs(along.y()) * r.half_length;
  constexpr int kFar = 1000;  // cells, to round down by truncation
  const auto cell_at = [](double x) { return static_cast<int>(x / kCellSize + kFar) - kFar; };
  const int column0 = cell_at(r.at.x() - extent_x);
  const int column1 = cell_at(r.at.x() + extent_x);
  const int row1 = std::min(cell_at(r.at.y() + extent_y), kCellsPerTile + NearGroundPoints::kMarginCells - 1);
  const Interval box{column0 * kCellSize - r.at.x(), (column1 + 1) * kCellSize - r.at.x()};
  const Band lengthwise(along.x(), along.y(), r.half_length);
  const Band crosswise(r.up.x(), r.up.y(), r.half_width);
  std::array<Run, kMaxRows> runs;
  std::size_t num_runs = 0;
  std::size_t n = 0;
  for (int row = std::max(cell_at(r.at.y() - extent_y), -NearGroundPoints::kMarginCells); row <= row1; ++row) {
    // Only the part of the row that the rectangle may cover.
    const Interval y{row * kCellSize - r.at.y(), (row + 1) * kCellSize - r.at.y()};
    Interval x = lengthwise.cut(box, y);
    if (trim == Trim::kBothWays) x = crosswise.cut(x, y);
    const auto [begin, end] = points_.range(std::max(column0, cell_at(r.at.x() + x.from - kRounding)),
                                            std::min(column1, cell_at(r.at.x() + x.to + kRounding)), row);
    const std::size_t num = end - begin;
    if (num == 0) continue;
    runs[num_runs++] = {begin, n, num};
    n += num;
  }
  window_.resize(n + NearGroundPoints::kPadding);  // turn_points() takes points in eights
  turn_points(points_.x(), points_.y(), points_.z(), points_.unfit(), runs.data(), num_runs, r, window_.u.data(),
              window_.t.data(), window_.z.data(), window_.unfit.data());
  window_.resize(n);
  window_.half_length = r.half_length;
}

bool StepSearch::fit_nearby(const Eigen::Vector2d& up, double half_length) {
  fit_window(up, half_length, Trim::kLengthwise);
  return count_points(window_) > kEnoughPoints;
}

double StepSearch::fit_window(const Eigen::Vector2d& up, double half_length, Trim trim) {
  fill_window(up, half_length, trim);
  ++effort_.windows;
  effort_.window_points += window_.size();
  const auto step = find_height_step(window_, noise_, parameters_);
  // Cheap checks first.
  if (!step) return 0;
  const double certain = certainty(*step, noise_, parameters_);
  if (!(certain >= 1) || step->height > parameters_.max_step) return certain;
  FoundStep* rival = nullptr;
  for (FoundStep& other : found_) {
    if (other.up.dot(up) > kSameDirection && (rival == nullptr || is_more_certain(other.step, rival->step)))
      rival = &other;
  }
  if (rival != nullptr && !is_more_certain(*step, rival->step)) return certain;
  const StepSides sides = evaluate_sides(window_, *step, parameters_);
  if (!separates_sides(sides, *step, parameters_)) return certain;
  const FoundStep found{*step, find_curb_face(window_, *step), up, half_length};
  if (rival != nullptr)
    *rival = found;
  else
    found_.push_back(found);
  return certain;
}

}  // namespace curbstone::semantic_map::curbs
