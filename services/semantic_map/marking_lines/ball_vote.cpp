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
  return std::min(1.0, double{cell.contrast} / kFullContrast);
}

PlaneVote vote_in_plane(const MarkingField& field, std::size_t cell, double sigma) {
  double xx = 0;
  double xy = 0;
  double yy = 0;
  double mass = 0;
  field.within(field.cells()[cell].at, kReach * sigma, [&](std::size_t j, const Eigen::Vector2d& d) {
    const MapMarkingCell& voter = field.cells()[j];
    if (j == cell || !voter.is_strong) return;
    const double squared = d.squaredNorm();
    if (squared == 0) return;
    const double w = weight_of(voter) * std::exp(-squared / (sigma * sigma));
    xx += w * (1 - d.x() * d.x() / squared);
    xy -= w * d.x() * d.y() / squared;
    yy += w * (1 - d.y() * d.y() / squared);
    mass += w;
  });
  return decompose(xx, xy, yy, mass);
}

}  // namespace curbstone::semantic_map::marking_lines
