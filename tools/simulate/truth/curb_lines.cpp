#include "tools/simulate/truth/curb_lines.hpp"

#include <cmath>
#include <cstdint>
#include <deque>
#include <map>
#include <set>

namespace curbstone::simulate::truth {

namespace {

/// A grid edge that the contour crosses, identified by its first node and its direction.
using EdgeKey = std::int64_t;

class Contours {
 public:
  explicit Contours(const world::Ground& ground) : ground_(ground) {
    for (int iy = 0; iy + 1 < ground.height(); ++iy) {
      for (int ix = 0; ix + 1 < ground.width(); ++ix) add_cell(ix, iy);
    }
  }

  std::vector<std::vector<Eigen::Vector2d>> lines() {
    std::vector<std::vector<Eigen::Vector2d>> all;
    std::set<EdgeKey> done;
    for (const auto& [start, ignored] : next_) {
      if (done.contains(start)) continue;
      std::deque<EdgeKey> line{start};
      done.insert(start);
      extend(line, done, true);
      extend(line, done, false);
      std::vector<Eigen::Vector2d> points;
      for (const EdgeKey key : line) points.push_back(points_.at(key));
      const auto& around = next_.at(line.front());  // closed if the last point is adjacent to the first
      if (line.size() > 2 && std::find(around.begin(), around.end(), line.back()) != around.end())
        points.push_back(points.front());
      all.push_back(std::move(points));
    }
    return all;
  }

 private:
  [[nodiscard]] double value(int ix, int iy) const {
    const double d = static_cast<double>(
        ground_.at(static_cast<float>(ground_.x_of(ix)), static_cast<float>(ground_.y_of(iy))).distance);
    return d == 0 ? 1e-9 : d;
  }
  EdgeKey cross(int ix, int iy, bool upwards) {
    const EdgeKey key = (static_cast<EdgeKey>(iy) * ground_.width() + ix) * 2 + (upwards ? 1 : 0);
    const double a = value(ix, iy), b = upwards ? value(ix, iy + 1) : value(ix + 1, iy);
    const double f = world::Ground::kPitch * a / (a - b);
    points_[key] = {ground_.x_of(ix) + (upwards ? 0 : f), ground_.y_of(iy) + (upwards ? f : 0)};
    return key;
  }
  void add_cell(int ix, int iy) {
    const bool a = value(ix, iy) > 0, b = value(ix + 1, iy) > 0, c = value(ix, iy + 1) > 0,
               d = value(ix + 1, iy + 1) > 0;
    std::vector<EdgeKey> crossings;
    if (a != b) crossings.push_back(cross(ix, iy, false));
    if (b != d) crossings.push_back(cross(ix + 1, iy, true));
    if (c != d) crossings.push_back(cross(ix, iy + 1, false));
    if (a != c) crossings.push_back(cross(ix, iy, true));
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
      next_[crossings[i]].push_back(crossings[i + 1]);
      next_[crossings[i + 1]].push_back(crossings[i]);
    }
  }
  void extend(std::deque<EdgeKey>& line, std::set<EdgeKey>& done, bool at_back) const {
    for (bool grown = true; grown;) {
      grown = false;
      for (const EdgeKey key : next_.at(at_back ? line.back() : line.front())) {
        if (!done.insert(key).second) continue;
        at_back ? line.push_back(key) : line.push_front(key);
        grown = true;
        break;
      }
    }
  }

  const world::Ground& ground_;
  std::map<EdgeKey, std::vector<EdgeKey>> next_;
  std::map<EdgeKey, Eigen::Vector2d> points_;
};

TrueCurbVertex curb_point(const world::Ground& ground, const Eigen::Vector2d& p) {
  const world::GroundVertex node = ground.at(static_cast<float>(p.x()), static_cast<float>(p.y()));
  const auto height = static_cast<double>(node.curb);
  return {{p.x(), p.y(), static_cast<double>(node.terrain)}, height, height < kDroppedBelow};
}

}  // namespace

std::vector<std::vector<TrueCurbVertex>> trace_curbs(const world::Ground& ground, double spacing) {
  std::vector<std::vector<TrueCurbVertex>> curbs;
  for (const auto& line : Contours(ground).lines()) {
    std::vector<TrueCurbVertex> curb{curb_point(ground, line.front())};
    double since = 0;
    for (std::size_t i = 1; i < line.size(); ++i) {
      const double length = (line[i] - line[i - 1]).norm();
      for (double at = spacing - since; at <= length; at += spacing)
        curb.push_back(curb_point(ground, line[i - 1] + (line[i] - line[i - 1]) * (at / length)));
      since = std::fmod(since + length, spacing);
    }
    curbs.push_back(std::move(curb));
  }
  return curbs;
}

}  // namespace curbstone::simulate::truth
