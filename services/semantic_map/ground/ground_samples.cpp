#include "services/semantic_map/ground/ground_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace curbstone::semantic_map::ground {

namespace {

constexpr float kLayer = 0.12F;        // m: points this close above the lowest one form one layer
constexpr float kOutlierShare = 0.1F;  // of a cell's points that may be too low (multiple reflections)

/// A point that may be ground.
struct Candidate {
  float z;              // m in map
  std::uint32_t point;  // of the tile
};

GroundSample lowest_layer(std::span<Candidate> candidates, const tile::VotedPoints& points) {
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return a.z < b.z; });
  const float low = candidates[static_cast<std::size_t>(kOutlierShare * static_cast<float>(candidates.size()))].z;
  const auto begin =
      std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& c) { return !(c.z < low - kLayer); });
  const auto end = std::find_if(begin, candidates.end(), [&](const Candidate& c) { return c.z > low + kLayer; });
  const auto count = static_cast<int>(end - begin);
  double sums[5] = {};
  for (auto at = begin; at != end; ++at) {
    const tile::VotedPoint p = points[at->point];
    const auto nz = static_cast<double>(p.normal.z());
    const double values[5] = {double{p.x}, double{p.y}, double{p.z}, -double{p.normal.x()} / nz,
                              -double{p.normal.y()} / nz};
    for (int k = 0; k < 5; ++k) sums[k] += values[k];
  }
  const auto mean = [&](int k) { return static_cast<float>(sums[k] / count); };
  double squares = 0;
  const float x = mean(0), y = mean(1), z = mean(2), slope_x = mean(3), slope_y = mean(4);
  for (auto at = begin; at != end; ++at) {
    const tile::VotedPoints::Place& p = points.places()[at->point];
    const float off = p.z - z - slope_x * (p.x - x) - slope_y * (p.y - y);
    squares += double{off} * double{off};
  }
  const auto spread = static_cast<float>(std::sqrt(squares / std::max(1, count - 1)));
  return {x, y, z, slope_x, slope_y, spread, count};
}

}  // namespace

GroundSamples sample_ground(const tile::VotedTile& tile, const tile::CurbParameters& parameters) {
  constexpr int n = GroundSamples::kPerSide;
  constexpr std::uint8_t kNone = n * n;
  const auto places = tile.points.places();
  const auto tensors = tile.points.tensors();
  std::vector<std::uint8_t> cell_of(places.size(), kNone);
  std::array<std::uint32_t, n * n + 1> begin{};  // of each cell's candidates
  for (std::size_t i = 0; i < places.size(); ++i) {
    const tile::VotedPoints::Place& p = places[i];
    if (!may_be_ground(tensors[p.tensor], parameters)) continue;
    const int column = std::clamp(static_cast<int>(double{p.x} / GroundSamples::kCell), 0, n - 1);
    const int row = std::clamp(static_cast<int>(double{p.y} / GroundSamples::kCell), 0, n - 1);
    cell_of[i] = static_cast<std::uint8_t>(row * n + column);
    ++begin[std::size_t{cell_of[i]} + 1];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Candidate> candidates(begin.back());
  auto next = begin;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (cell_of[i] != kNone) candidates[next[cell_of[i]]++] = {places[i].z, static_cast<std::uint32_t>(i)};
  }
  GroundSamples samples;
  for (std::size_t c = 0; c < samples.cells.size(); ++c) {
    const auto of_cell = std::span(candidates).subspan(begin[c], begin[c + 1] - begin[c]);
    if (!of_cell.empty()) samples.cells[c] = lowest_layer(of_cell, tile.points);
  }
  return samples;
}

}  // namespace curbstone::semantic_map::ground
