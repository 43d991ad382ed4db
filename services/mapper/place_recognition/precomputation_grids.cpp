#include "services/mapper/place_recognition/precomputation_grids.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace curbstone::mapper::place_recognition {
namespace {

constexpr int kBlur = 2;         // cells about a point
constexpr double kSigma = 0.25;  // m: half a step of the search, and the accuracy of a wall in a downsampled scan

using Lattice = std::vector<std::uint8_t>;

std::array<std::uint8_t, (2 * kBlur + 1) * (2 * kBlur + 1)> bell() {
  std::array<std::uint8_t, (2 * kBlur + 1) * (2 * kBlur + 1)> out{};
  std::size_t i = 0;
  for (int y = -kBlur; y <= kBlur; ++y) {
    for (int x = -kBlur; x <= kBlur; ++x) {
      const double d2 = (x * x + y * y) * PrecomputationGrids::kCell * PrecomputationGrids::kCell;
      out[i++] = static_cast<std::uint8_t>(std::lround(255 * std::exp(-0.5 * d2 / (kSigma * kSigma))));
    }
  }
  return out;
}

/// The maximum of each cell and the one `step` further on, first along rows, then along columns.
Lattice coarser(const Lattice& fine, int side, int step) {
  Lattice rows(fine.size()), out(fine.size());
  const auto n = static_cast<std::size_t>(side), s = static_cast<std::size_t>(step);
  for (std::size_t y = 0; y < n; ++y) {
    const std::uint8_t* from = &fine[y * n];
    std::uint8_t* to = &rows[y * n];
    for (std::size_t x = 0; x + s < n; ++x) to[x] = std::max(from[x], from[x + s]);
    for (std::size_t x = n - s; x < n; ++x) to[x] = from[x];
  }
  for (std::size_t y = 0; y < n; ++y) {
    const std::uint8_t* from = &rows[y * n];
    const std::uint8_t* other = y + s < n ? from + s * n : from;
    for (std::size_t x = 0; x < n; ++x) out[y * n + x] = std::max(from[x], other[x]);
  }
  return out;
}

}  // namespace

PrecomputationGrids::PrecomputationGrids(const std::vector<Eigen::Vector3f>& points, double reach)
    : reach_(reach), side_(2 * static_cast<int>(std::ceil(reach / kCell)) + 1) {
  const auto n = static_cast<std::size_t>(side_);
  Lattice occupied(n * n), finest(n * n);
  for (const Eigen::Vector3f& p : points) {
    const int x = cell(static_cast<double>(p.x())), y = cell(static_cast<double>(p.y()));
    if (x < kBlur || y < kBlur || x >= side_ - kBlur || y >= side_ - kBlur) continue;
    occupied[static_cast<std::size_t>(y * side_ + x)] = 1;
  }
  const auto around = bell();
  for (int y = kBlur; y < side_ - kBlur; ++y) {
    for (int x = kBlur; x < side_ - kBlur; ++x) {
      if (occupied[static_cast<std::size_t>(y * side_ + x)] == 0) continue;
      std::size_t i = 0;
      for (int v = y - kBlur; v <= y + kBlur; ++v) {
        for (int u = x - kBlur; u <= x + kBlur; ++u, ++i) {
          std::uint8_t& value = finest[static_cast<std::size_t>(v * side_ + u)];
          value = std::max(value, around[i]);
        }
      }
    }
  }
  levels_.push_back(std::move(finest));
  for (int k = 1; k < kLevels; ++k) levels_.push_back(coarser(levels_.back(), side_, 1 << (k - 1)));
}

double PrecomputationGrids::at(const Eigen::Vector3f& point) const {
  const int x = cell(static_cast<double>(point.x())), y = cell(static_cast<double>(point.y()));
  if (x < 0 || y < 0 || x >= side_ || y >= side_) return 0;
  return levels_.front()[static_cast<std::size_t>(y * side_ + x)] / 255.0;
}

int PrecomputationGrids::cell(double v) const {
  if (!(std::abs(v) < reach_ + 1e3)) return -1;
  return static_cast<int>(std::floor((v + reach_) / kCell));
}

}  // namespace curbstone::mapper::place_recognition
