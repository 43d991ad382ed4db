#include "street_truth.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

namespace curbstone {

namespace {

enum class Side { kNone, kRoad, kParking, kSidewalk, kTerrain, kVegetation };

Side side_of(std::uint32_t label) {
  switch (label & 0xffff) {
    case 40:
      return Side::kRoad;
    case 44:
      return Side::kParking;
    case 48:
      return Side::kSidewalk;
    case 72:
      return Side::kTerrain;
    case 70:
      return Side::kVegetation;
    default:
      return Side::kNone;
  }
}

struct Labelled {
  Eigen::Vector3d p;
  Side side;
};

/// Points in cells of 0.3 m, for neighbours.
class PlaneGrid {
 public:
  explicit PlaneGrid(const std::vector<Labelled>& points) : points_(points) {
    for (std::size_t i = 0; i < points.size(); ++i) cells_[cell(points[i].p.head<2>())].push_back(i);
  }
  template <class Visit>
  void within(const Eigen::Vector2d& at, double radius, Visit visit) const {
    const int reach = static_cast<int>(std::ceil(radius / kCell));
    const auto c = cell(at);
    for (int x = c.first - reach; x <= c.first + reach; ++x) {
      for (int y = c.second - reach; y <= c.second + reach; ++y) {
        const auto it = cells_.find({x, y});
        if (it == cells_.end()) continue;
        for (const std::size_t i : it->second) {
          if ((points_[i].p.head<2>() - at).norm() <= radius) visit(i);
        }
      }
    }
  }

 private:
  static constexpr double kCell = 0.3;
  static std::pair<int, int> cell(const Eigen::Vector2d& p) {
    return {static_cast<int>(std::floor(p.x() / kCell)), static_cast<int>(std::floor(p.y() / kCell))};
  }
  const std::vector<Labelled>& points_;
  std::map<std::pair<int, int>, std::vector<std::size_t>> cells_;
};

bool is_pair(Side low, Side high) {
  return (high == Side::kSidewalk && (low == Side::kRoad || low == Side::kParking)) ||
         (low == Side::kRoad && high == Side::kTerrain);
}

bool is_dont_care(Side a, Side b) {
  const auto is = [&](Side x, Side y) { return (a == x && b == y) || (a == y && b == x); };
  return is(Side::kRoad, Side::kParking) || is(Side::kRoad, Side::kVegetation) ||
         is(Side::kSidewalk, Side::kVegetation) || is(Side::kSidewalk, Side::kTerrain);
}

/// The offset between the points of two labels about a place, with a slope that both share.
double step_at(const std::vector<Labelled>& points, const PlaneGrid& grid, const Eigen::Vector2d& at, Side low,
               Side high) {
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  int count[2] = {};
  grid.within(at, 0.6, [&](std::size_t i) {
    const Labelled& l = points[i];
    if (l.side != low && l.side != high) return;
    const bool is_high = l.side == high;
    ++count[is_high ? 1 : 0];
    const Eigen::Vector4d row(1, is_high ? 1 : 0, l.p.x() - at.x(), l.p.y() - at.y());
    A += row * row.transpose();
    b += row * l.p.z();
  });
  if (count[0] < 6 || count[1] < 6) return std::nan("");
  A(2, 2) += 0.01;
  A(3, 3) += 0.01;
  return A.ldlt().solve(b)(1);
}

void add_pairs(const std::vector<Labelled>& points, const PlaneGrid& grid, StreetTruth& truth) {
  constexpr double kApart = 0.30;
  const auto nearest_other = [&](std::size_t i, auto accept) {
    std::size_t best = points.size();
    double best_distance = kApart;
    grid.within(points[i].p.head<2>(), kApart, [&](std::size_t j) {
      const double d = (points[j].p - points[i].p).head<2>().norm();
      if (accept(points[j].side) && d < best_distance) {
        best = j;
        best_distance = d;
      }
    });
    return best;
  };
  std::set<std::pair<int, int>> taken;  // one a 0.1 m cell
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Side mine = points[i].side;
    const std::size_t j = nearest_other(i, [&](Side s) { return is_pair(mine, s) || is_dont_care(mine, s); });
    if (j == points.size()) continue;
    const Side other = points[j].side;
    if (nearest_other(j, [&](Side s) { return s == mine; }) != i) continue;
    const Eigen::Vector2d at = 0.5 * (points[i].p + points[j].p).head<2>();
    if (!taken.insert({static_cast<int>(std::floor(at.x() * 10)), static_cast<int>(std::floor(at.y() * 10))}).second)
      continue;
    if (is_pair(mine, other)) {
      const double step = step_at(points, grid, at, mine, other);
      if (std::isfinite(step)) truth.points.push_back({at, step, true});
    } else {
      truth.points.push_back({at, 0, false});
    }
  }
}

/// Median of the steps along 0.75 m; drops points with no company (a line has gaps of 0.8 m at most).
void smooth(StreetTruth& truth) {
  std::vector<TruthPoint> smoothed;
  for (const TruthPoint& p : truth.points) {
    if (!p.counts) {
      smoothed.push_back(p);
      continue;
    }
    std::vector<double> steps;
    int company = 0;
    for (const TruthPoint& q : truth.points) {
      if (!q.counts) continue;
      const double d = (q.at - p.at).norm();
      if (d <= 0.375) steps.push_back(q.step);
      if (d <= 0.8) ++company;
    }
    if (company < 5) continue;
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
    smoothed.push_back({p.at, steps[steps.size() / 2], true});
  }
  truth.points = std::move(smoothed);
}

/// Links what is no farther apart than 0.8 m: a line every 0.1 m instead of points where scan lines cross it.
void link(StreetTruth& truth) {
  constexpr double kGap = 0.8;
  std::set<std::pair<int, int>> taken;
  const auto cell = [](const Eigen::Vector2d& p) {
    return std::pair(static_cast<int>(std::floor(p.x() * 10)), static_cast<int>(std::floor(p.y() * 10)));
  };
  for (const TruthPoint& p : truth.points) taken.insert(cell(p.at));
  const std::vector<TruthPoint> points = truth.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      const double d = (points[j].at - points[i].at).norm();
      if (points[i].counts != points[j].counts || d > kGap) continue;
      for (double s = 0.05; s < d; s += 0.05) {
        const Eigen::Vector2d at = points[i].at + s / d * (points[j].at - points[i].at);
        if (!taken.insert(cell(at)).second) continue;
        truth.points.push_back({at, points[i].step + s / d * (points[j].step - points[i].step), points[i].counts});
      }
    }
  }
}

}  // namespace

bool StreetTruth::is_labelled_around(const Eigen::Vector2d& p) const {
  int quadrants = 0;
  for (int q = 0; q < 4; ++q) {
    const Eigen::Vector2d at = p + Eigen::Vector2d(q % 2 == 0 ? 0.25 : -0.25, q / 2 == 0 ? 0.25 : -0.25);
    if (std::any_of(labelled.begin(), labelled.end(), [&](const Eigen::Vector2d& l) { return (l - at).norm() < 0.25; }))
      ++quadrants;
  }
  return quadrants == 4;
}

std::vector<Eigen::Vector3f> read_scan(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::vector<Eigen::Vector3f> points;
  float row[4];
  while (in.read(reinterpret_cast<char*>(row), sizeof row)) points.emplace_back(row[0], row[1], row[2]);
  return points;
}

std::vector<Eigen::Isometry3d> read_poses(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<Eigen::Isometry3d> poses;
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream row(line);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) row >> pose.matrix()(r, c);
    }
    if (row) poses.push_back(pose);
  }
  return poses;
}

StreetTruth make_street_truth(const std::filesystem::path& folder) {
  const auto poses = read_poses(folder / "reference_poses.txt");
  std::vector<Labelled> points;
  for (std::size_t k = 0; k < 3; ++k) {
    char name[16];
    std::snprintf(name, sizeof name, "%06zu", k);
    const auto scan = read_scan(folder / "scans" / (std::string(name) + ".bin"));
    std::ifstream in(folder / "labels" / (std::string(name) + ".label"), std::ios::binary);
    for (const Eigen::Vector3f& p : scan) {
      std::uint32_t label = 0;
      if (!in.read(reinterpret_cast<char*>(&label), sizeof label)) break;
      const Side side = side_of(label);
      if (side != Side::kNone && p.norm() < 30) points.push_back({poses[k] * p.cast<double>(), side});
    }
  }
  const PlaneGrid grid(points);
  StreetTruth truth;
  add_pairs(points, grid, truth);
  smooth(truth);
  link(truth);
  std::set<std::pair<int, int>> cells;
  for (const Labelled& l : points) {
    if (l.side == Side::kRoad || l.side == Side::kSidewalk || l.side == Side::kParking || l.side == Side::kTerrain)
      cells.insert({static_cast<int>(std::floor(l.p.x() * 4)), static_cast<int>(std::floor(l.p.y() * 4))});
  }
  for (const auto& [x, y] : cells) truth.labelled.emplace_back((x + 0.5) / 4, (y + 0.5) / 4);
  return truth;
}

StreetScore score_street(const std::vector<Detection>& detections, const StreetTruth& truth, double tolerance,
                         double range) {
  constexpr double kMinStep = 0.04;
  constexpr double kBlind = 4.0;  // m around the sensor: it does not see the ground there
  StreetScore score;
  const auto near = [&](const Eigen::Vector2d& at, auto accept) {
    const TruthPoint* best = nullptr;
    double best_distance = tolerance;
    for (const TruthPoint& t : truth.points) {
      const double d = (t.at - at).norm();
      if (accept(t) && d <= best_distance) {
        best = &t;
        best_distance = d;
      }
    }
    return best;
  };
  const auto is_high = [](const TruthPoint& t) { return t.counts && t.step >= kMinStep; };
  std::vector<double> lateral;
  for (const Detection& d : detections) {
    if (d.at.norm() > range || d.at.norm() < kBlind) continue;
    if (const TruthPoint* t = near(d.at, is_high)) {
      ++score.detections;
      ++score.right;
      lateral.push_back((d.at - t->at).dot(d.up));
    } else if (near(d.at, [](const TruthPoint&) { return true; }) != nullptr || !truth.is_labelled_around(d.at)) {
      ++score.dont_care;
    } else {
      ++score.detections;
    }
  }
  int total[5] = {};
  int hit[5] = {};
  for (const TruthPoint& t : truth.points) {
    if (!t.counts || t.at.norm() > range) continue;
    const bool found = std::any_of(detections.begin(), detections.end(),
                                   [&](const Detection& d) { return (d.at - t.at).norm() <= tolerance; });
    const int k = t.step < 0.015 ? 0 : t.step < 0.03 ? 1 : t.step < 0.04 ? 2 : t.step < 0.05 ? 3 : 4;
    ++total[k];
    hit[k] += found ? 1 : 0;
    if (!is_high(t)) continue;
    ++score.truth;
    score.found += found ? 1 : 0;
  }
  for (int k = 0; k < 5; ++k) score.recall_by_step[k] = total[k] > 0 ? static_cast<double>(hit[k]) / total[k] : 0;
  score.precision = score.detections > 0 ? static_cast<double>(score.right) / score.detections : 0;
  score.recall = score.truth > 0 ? static_cast<double>(score.found) / score.truth : 0;
  const double sum = score.precision + score.recall;
  score.f1 = sum > 0 ? 2 * score.precision * score.recall / sum : 0;
  if (!lateral.empty()) {
    const auto middle = lateral.begin() + static_cast<std::ptrdiff_t>(lateral.size() / 2);
    std::nth_element(lateral.begin(), middle, lateral.end());
    score.bias = *middle;
    for (double& l : lateral) l = std::abs(l - score.bias);
    std::nth_element(lateral.begin(), middle, lateral.end());
    score.spread = 1.4826 * *middle;
  }
  return score;
}

}  // namespace curbstone
