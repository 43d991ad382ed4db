#include "services/semantic_map/curbs/curb_evidence.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "services/semantic_map/curbs/near_ground_points.hpp"
#include "services/semantic_map/curbs/step_search.hpp"

namespace curbstone::semantic_map::curbs {

namespace {

constexpr double kMinCoarseTilt = 0.008;  // slope
constexpr int kMinTilted = 1;             // points in a cell
constexpr double kSparse = 2.0;           // factor of the window's length where points are few,
constexpr double kThin = 4.0;             // and where there are only single scan lines
constexpr double kPromising = 0.1;        // certainty straight ahead; with less, a step in a turned direction is noise

/// A cell whose normals tilt, with the direction of the tilt.
struct TiltedCell {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  Eigen::Vector2d tilt = Eigen::Vector2d::Zero();
  int count = 0;
  bool is_thin = false;  // scan lines only: the direction is that of coarse_tilt, not of the vote
};

TiltedCell gather_tilt(const NearGroundPoints& points, const ground::GroundSurface& ground, int column, int row,
                       const tile::CurbParameters& parameters) {
  TiltedCell cell;
  points.for_cell(column, row, [&](const NearGround& p) {
    if (parameters.use_tilt && !p.tilted) return;
    cell.at += Eigen::Vector2d(double{p.x}, double{p.y});
    cell.tilt += Eigen::Vector2d(double{p.tilt_x}, double{p.tilt_y});
    ++cell.count;
  });
  if (cell.count > 0) {
    cell.at /= cell.count;
    cell.tilt /= cell.count;
    return cell;
  }
  points.for_cell(column, row, [&](const NearGround& p) {
    if (!p.is_line) return;
    cell.at += Eigen::Vector2d(double{p.x}, double{p.y});
    ++cell.count;
  });
  if (cell.count == 0) return cell;
  cell.at /= cell.count;
  cell.is_thin = true;
  if (const auto here = ground.at(cell.at.x(), cell.at.y())) cell.tilt = here->coarse_tilt;
  if (cell.tilt.norm() < kMinCoarseTilt) cell.count = 0;
  return cell;
}

/// The steps at a cell. Where points are dense, the direction of the vote is good, and a short window suffices. Where
/// they are few, longer windows are used, in the directions of the vote and of coarse_tilt, and turned from these.
std::vector<FoundStep> find_steps(const NearGroundPoints& points, const TiltedCell& cell,
                                  const ground::GroundAt& ground, const tile::CurbParameters& parameters,
                                  StepWindow& window, SearchEffort& effort) {
  StepSearch search(points, cell.at, ground.layer_noise, parameters, window, effort);
  std::array<std::pair<Eigen::Vector2d, double>, 2> directions;  // each with its certainty straight ahead
  std::size_t num_directions = 0;
  const double length = parameters.half_length;
  if (!cell.is_thin) {
    const Eigen::Vector2d up = cell.tilt.normalized();
    if (search.fit_nearby(up, length)) return search.found();
    directions[num_directions++] = {up, search.fit(up, kSparse * length)};
  }
  if (ground.coarse_tilt.norm() > kMinCoarseTilt) {
    const Eigen::Vector2d up = ground.coarse_tilt.normalized();
    directions[num_directions++] = {up, search.fit(up, kSparse * length)};
  }
  for (const auto& [direction, promise] : std::span(directions).first(num_directions)) {
    if (std::max(search.fit(direction, kThin * length), promise) < kPromising) continue;
    for (const double turn : {-0.12, 0.12, -0.24, 0.24})
      search.fit(Eigen::Rotation2Dd(turn) * direction, kThin * length);
  }
  return search.found();
}

CurbCandidate candidate_of(const FoundStep& found, const TiltedCell& cell, const tile::CurbParameters& parameters) {
  CurbCandidate candidate;
  candidate.at = cell.at + found.face.middle * found.up;
  candidate.up = found.up;
  candidate.z = found.step.low_z - 0.5 * (found.step.full_height - found.step.height);
  candidate.height = found.step.full_height;
  candidate.lean = found.face.lean;
  candidate.reach = found.half_length;
  candidate.score = found.step.height / found.step.sigma;
  candidate.weak = found.step.height < parameters.min_step;
  candidate.falls = found.step.falls();
  return candidate;
}

/// A candidate from the tilt alone (ablation).
CurbCandidate candidate_of(const TiltedCell& cell) {
  CurbCandidate candidate;
  candidate.at = cell.at;
  candidate.up = cell.tilt.normalized();
  candidate.height = 0.5 * cell.tilt.norm();  // the step that tilts normals by this much at sigma 0.3
  candidate.score = cell.tilt.norm();
  return candidate;
}

std::vector<CurbCandidate> test_cell(const NearGroundPoints& points, const TiltedCell& cell,
                                     const ground::GroundSurface& ground, const tile::CurbParameters& parameters,
                                     StepWindow& window, SearchEffort& effort) {
  if (!(cell.tilt.norm() > 1e-6)) return {};
  if (!parameters.use_step) return {candidate_of(cell)};
  const auto here = ground.at(cell.at.x(), cell.at.y());
  if (!here) return {};
  std::vector<CurbCandidate> candidates;
  for (const FoundStep& found : find_steps(points, cell, *here, parameters, window, effort))
    candidates.push_back(candidate_of(found, cell, parameters));
  return candidates;
}

}  // namespace

CurbEvidence find_curb_evidence(const tile::Around<tile::VotedTile>& tiles, const ground::GroundSurface& ground,
                                const tile::CurbParameters& parameters) {
  CurbEvidence evidence;
  thread_local NearGroundPoints points;  // keeps its memory for the next tile
  thread_local StepWindow window;
  points.gather(tiles, ground, parameters);
  evidence.effort.points = points.num_gathered();
  for (int row = 0; row < kCellsPerTile; ++row) {
    for (int column = 0; column < kCellsPerTile; ++column) {
      const TiltedCell cell = gather_tilt(points, ground, column, row, parameters);
      if (cell.count < kMinTilted) continue;
      for (CurbCandidate& candidate : test_cell(points, cell, ground, parameters, window, evidence.effort)) {
        const auto height = ground.height(candidate.at.x(), candidate.at.y());
        if (!height) continue;
        candidate.z += *height;
        evidence.candidates.push_back(candidate);
      }
    }
  }
  return evidence;
}

}  // namespace curbstone::semantic_map::curbs
