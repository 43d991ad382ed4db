#include "services/semantic_map/marking_lines/ball_vote.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::semantic_map::marking_lines {
namespace {

constexpr double kReach = 2.5;          // of sigma, in x and in y
constexpr double kFullContrast = 60.0;  // worn paint counts less

PlaneVote decompose(double xx, double xy, double yy, double mass) {
  const double middle = (xx + yy) / 2;
  const double half = std::hypot((xx - yy) / 2, xy);
  const double normal = 0.5 * std::atan2(2 * xy, xx - yy);
  PlaneVote vote;
  vote.mass = mass;
  vote.tangent = {-std::sin(normal), std::cos(normal)};
  vote.stick = middle + half > 0 ? 2 * half / (middle + half) : 0;
  return vote;
}

}  // namespace

double weight_of(const MapMarkingCell& cell) {
  return std::min(1.0, cell.contrast / kFullContrast);
}

std::vector<PlaneVote> vote_in_plane(const MarkingField& field, double sigma) {
  const std::vector<MapMarkingCell>& cells = field.cells();
  std::vector<PlaneVote> votes(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!cells[i].is_strong) continue;
    double xx = 0;
    double xy = 0;
    double yy = 0;
    double mass = 0;
    field.within(cells[i].at, kReach * sigma, [&](std::size_t j, const Eigen::Vector2d& d) {
      if (j == i || !cells[j].is_strong) return;
      const double squared = d.squaredNorm();
      if (squared == 0) return;
      const double w = weight_of(cells[j]) * std::exp(-squared / (sigma * sigma));
      xx += w * (1 - d.x() * d.x() / squared);
      xy -= w * d.x() * d.y() / squared;
      yy += w * (1 - d.y() * d.y() / squared);
      mass += w;
    });
    votes[i] = decompose(xx, xy, yy, mass);
  }
  return votes;
}

}  // namespace curbstone::semantic_map::marking_lines
