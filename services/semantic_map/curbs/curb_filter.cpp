#include "services/semantic_map/curbs/curb_filter.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <span>
#include <tuple>

#include "common/linear/decompositions.hpp"
#include "services/semantic_map/curbs/curb_support.hpp"

namespace curbstone::semantic_map::curbs {

namespace {

constexpr double kAcross = 0.50;       // m: ghosts of a step appear up to this far beside it
constexpr double kAlong = 0.15;        // m: and this far along
constexpr double kSameLine = 0.04;     // m: closer across is the same line, not a ghost
constexpr double kMargin = 3.0;        // m around the tile within which candidates can matter
constexpr double kMaxLineReach = 2.2;  // m each way over which a line is tested
constexpr double kMinExtent = 0.8;     // m of line around a detection
constexpr double kReaches = 2.0;       // a line is tested over so many reaches of the evidence, as few points give few
constexpr double kWeakReach = 1.5;     // m from a weak detection to the strong ones of its line, at most
constexpr int kRounds = 8;             // of kWeakReach: enough to cross the tile and its margin
constexpr double kWeakLateral = 0.10;  // m by which it may be off that line
constexpr double kWeakSupport = 2.5;   // factor of line_sigmas: low steps must support each other, too

/// A candidate that competes with others.
struct Placed : PlacedCandidate {
  double certainty = 0;  ///< pooled along its line
};

/// Distance of a place from the tile, the larger of x and y, m; negative inside.
double outside(const Eigen::Vector2d& at) {
  return std::max((-at).maxCoeff(), at.maxCoeff() - kTileSize);
}

/// Whether a candidate may become a curb point of the tile.
bool may_be_of_tile(const PlacedCandidate& p) {
  return outside(p.at) <= 0 && !(p.candidate->falls && !p.candidate->weak);
}

std::vector<PlacedCandidate> candidates_around(const tile::Around<std::vector<CurbCandidate>>& tiles) {
  std::vector<PlacedCandidate> candidates;
  tiles.for_each([&](const std::vector<CurbCandidate>& of_tile, double dx, double dy) {
    for (const CurbCandidate& c : of_tile) candidates.push_back({c.at + Eigen::Vector2d(dx, dy), c.up, &c});
  });
  return candidates;
}

/// The candidates within kMargin of the tile, by x, with their certainty pooled along their lines.
std::vector<Placed> pooled_candidates(const CandidateField& field) {
  std::vector<Placed> placed;
  for (const PlacedCandidate& c : field.by_x()) {
    if (outside(c.at) < kMargin) placed.push_back({c, field.pool_along_line(c)});
  }
  return placed;
}

/// The candidate with more certainty along its line goes first; ties are broken by place, so that two candidates never
/// suppress each other.
bool outranks(const Placed& a, const Placed& b) {
  return std::make_tuple(a.certainty, a.at.x(), a.at.y()) > std::make_tuple(b.certainty, b.at.x(), b.at.y());
}

bool is_ghost(const Placed& p, const std::vector<Placed>& all) {
  constexpr double kRivals = kAcross + kAlong;  // m each way
  const auto rivals = near_x(all, p.at.x(), kRivals);
  return std::any_of(rivals.begin(), rivals.end(), [&](const Placed& other) {
    if (std::abs(p.at.y() - other.at.y()) > kRivals || !outranks(other, p)) return false;
    const Eigen::Vector2d d = p.at - other.at;
    const double across = std::abs(d.dot(other.up));
    const double along = std::abs(d.x() * other.up.y() - d.y() * other.up.x());
    return across > kSameLine && across < kAcross && along < kAlong;
  });
}

/// Of candidates on one line, the one whose own step is clearest gives the best place and height.
bool is_surer(const Placed& a, const Placed& b) {
  return a.certainty * a.candidate->score > b.certainty * b.candidate->score;
}

/// The line through the detections around a place.
struct LocalLine {
  int count = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();
  double linearity = 1;  ///< minor over major spread
  double extent = 0;     ///< m, major spread
  double score = 0;      ///< mean
};

template <class Accept>
LocalLine line_around(const Eigen::Vector2d& at, double radius, const std::vector<Placed>& all, Accept accept) {
  LocalLine line;
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const Placed& other : near_x(all, at.x(), radius)) {
    const Eigen::Vector2d d = other.at - at;
    if (d.squaredNorm() > radius * radius || !accept(other)) continue;
    ++line.count;
    line.score += other.candidate->score;
    line.mean += d;
    scatter += d * d.transpose();
  }
  if (line.count < 2) return line;
  line.mean /= line.count;
  line.score /= line.count;
  scatter = scatter / line.count - line.mean * line.mean.transpose();
  const auto [values, vectors] = eigen_pairs<2>(scatter);
  const double minor = std::sqrt(std::max(0.0, values(0)));
  const double major = std::sqrt(std::max(0.0, values(1)));
  line.direction = vectors.col(1);
  line.linearity = major > 0 ? minor / major : 1;
  line.extent = major * std::sqrt(12.0);  // of evenly spaced points
  line.mean += at;
  return line;
}

bool is_on_line(const Placed& p, const std::vector<Placed>& strong, const tile::CurbParameters& parameters) {
  const auto alike = [&](const Placed& o) { return std::abs(o.up.dot(p.up)) > 0.6; };
  const double radius = std::min(kMaxLineReach, std::max(parameters.linearity_radius, kReaches * p.candidate->reach));
  const LocalLine line = line_around(p.at, radius, strong, alike);
  return line.count > parameters.min_neighbours && line.linearity < parameters.max_linearity &&
         line.extent > kMinExtent && std::abs(line.direction.dot(p.up)) < 0.6;
}

/// Whether the steps along a line support each other: a short line needs more certain steps than a long one.
bool is_supported(const Placed& p, const std::vector<Placed>& kept, const tile::CurbParameters& parameters) {
  if (!parameters.use_step) return true;  // a tilt alone has no certainty
  const auto alike = [&](const Placed& o) { return std::abs(o.up.dot(p.up)) > 0.6; };
  const LocalLine line = line_around(p.at, kMaxLineReach, kept, alike);
  return line.score * std::sqrt(line.extent) >= parameters.line_sigmas;
}

bool continues_line(const Placed& p, const std::vector<Placed>& confirmed, const tile::CurbParameters& parameters) {
  if (p.certainty < kWeakSupport * parameters.line_sigmas) return false;
  const auto alike = [&](const Placed& o) { return o.up.dot(p.up) > 0.8; };
  const LocalLine line = line_around(p.at, kWeakReach, confirmed, alike);
  if (line.count < 4 || line.linearity > 0.2 || line.extent < kMinExtent) return false;
  const Eigen::Vector2d d = p.at - line.mean;
  const double lateral = std::abs(d.x() * line.direction.y() - d.y() * line.direction.x());
  return lateral < kWeakLateral && std::abs(line.direction.dot(p.up)) < 0.4;
}

/// Adds low steps that continue a line, then those that continue these, and so on: a lowered kerb is followed from its
/// ends. `kept` stays sorted by x.
void grow_lowered(std::vector<Placed> weak, const tile::CurbParameters& parameters, std::vector<Placed>& kept) {
  bool grows = true;
  for (int round = 0; grows && round < kRounds; ++round) {
    const auto goes_on = std::stable_partition(weak.begin(), weak.end(),
                                               [&](const Placed& p) { return !continues_line(p, kept, parameters); });
    grows = goes_on != weak.end();
    kept.insert(kept.end(), goes_on, weak.end());
    weak.erase(goes_on, weak.end());
    std::stable_sort(kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.at.x() < b.at.x(); });
  }
}

/// The candidates that no rival suppresses, by x.
struct Survivors {
  std::vector<Placed> strong;  ///< as high as a curb
  std::vector<Placed> weak;    ///< lower
};

Survivors suppress_ghosts(const std::vector<Placed>& all) {
  Survivors survivors;
  for (const Placed& p : all) {
    // A step that falls only suppresses others: where noise is the best explanation, there is no curb. Low steps are
    // exempt: they need a line that they continue, and a lowered kerb is a lip at the foot of a ramp.
    if (p.candidate->falls && !p.candidate->weak) continue;
    if (!is_ghost(p, all)) (p.candidate->weak ? survivors.weak : survivors.strong).push_back(p);
  }
  return survivors;
}

/// The candidates for which accept(p) is true.
template <class Accept>
std::vector<Placed> filtered(const std::vector<Placed>& candidates, Accept accept) {
  std::vector<Placed> accepted;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(accepted), accept);
  return accepted;
}

/// The most certain candidate of each cell of the tile, by cell.
std::map<int, Placed> surest_by_cell(const std::vector<Placed>& kept) {
  std::map<int, Placed> best;
  for (const Placed& p : kept) {
    if ((p.at.array() < 0).any() || (p.at.array() >= kTileSize).any()) continue;
    const int column = std::min(kCellsPerTile - 1, static_cast<int>(p.at.x() / kCellSize));
    const int row = std::min(kCellsPerTile - 1, static_cast<int>(p.at.y() / kCellSize));
    const auto [it, inserted] = best.try_emplace(row * kCellsPerTile + column, p);
    if (!inserted && is_surer(p, it->second)) it->second = p;
  }
  return best;
}

/// The foot lies in front of the face's middle, by half the height times the lean of the face along the line.
CurbPoint curb_point(const Placed& p, const std::vector<PlacedCandidate>& kept) {
  const CurbCandidate& c = *p.candidate;
  const double confidence = c.weak ? 0.5 : std::min(1.0, 0.5 + c.score / 60);
  const double lean = lean_along_line(p, near_x(kept, p.at.x(), kLineReach));
  const Eigen::Vector2d foot = p.at - 0.5 * c.height * lean * p.up;
  return {foot, p.up, c.z, c.height, confidence, c.weak, c.reach};
}

}  // namespace

std::vector<CurbPoint> filter_curbs(const tile::Around<std::vector<CurbCandidate>>& candidates,
                                    const tile::CurbParameters& parameters) {
  std::vector<PlacedCandidate> around = candidates_around(candidates);
  if (std::none_of(around.begin(), around.end(), may_be_of_tile)) return {};
  Survivors survivors = suppress_ghosts(pooled_candidates(CandidateField(std::move(around))));
  const std::vector<Placed>& strong = survivors.strong;
  const std::vector<Placed> on_line =
      filtered(strong, [&](const Placed& p) { return is_on_line(p, strong, parameters); });
  std::vector<Placed> kept = filtered(on_line, [&](const Placed& p) { return is_supported(p, on_line, parameters); });
  grow_lowered(std::move(survivors.weak), parameters, kept);

  const std::vector<PlacedCandidate> of_lines(kept.begin(), kept.end());
  std::vector<CurbPoint> points;
  for (const auto& [cell, p] : surest_by_cell(kept)) points.push_back(curb_point(p, of_lines));
  return points;
}

}  // namespace curbstone::semantic_map::curbs
