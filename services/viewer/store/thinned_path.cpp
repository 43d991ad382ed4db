#include "services/viewer/store/thinned_path.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::viewer::store {
namespace {

bool are_near(const ThinnedPath::Point& a, const ThinnedPath::Point& b) {
  return std::hypot(a.x - b.x, a.y - b.y) < ThinnedPath::kSpacing;
}

}  // namespace

void ThinnedPath::put(const Point& point) {
  if (points_.size() >= kMaxPoints) return;
  if (points_.empty() || points_.back().utime < point.utime) {
    if (points_.empty() || !are_near(points_.back(), point)) points_.push_back(point);
    return;
  }
  const auto next = std::lower_bound(points_.begin(), points_.end(), point,
                                     [](const Point& a, const Point& b) { return a.utime < b.utime; });
  if (are_near(*next, point) || (next != points_.begin() && are_near(*(next - 1), point))) return;
  points_.insert(next, point);
  ++round_;
}

void ThinnedPath::append(Point point) {
  if (point.utime + behind_ <= newest_) behind_ = newest_ + 1 - point.utime;
  newest_ = point.utime += behind_;
  put(point);
}

void ThinnedPath::clear() {
  points_.clear();
  newest_ = behind_ = 0;
  ++round_;
}

}  // namespace curbstone::viewer::store
