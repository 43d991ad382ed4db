#include "tools/bench/curbs/scores/bin_score.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace curbstone::bench::curbs::scores {

namespace {

constexpr double kBinLength = 0.5;  // m
constexpr int kBins = 40;           // x 0..20 m
constexpr double kRight = 0.15;     // m
constexpr double kCounted = 0.5;    // m
constexpr double kFar = 1e9;

}  // namespace

BinScore score_bins(const std::vector<evaluate::CurbFoot>& feet, const scenes::CurbScene& scene,
                    const std::vector<Eigen::Vector3d>& eyes) {
  const scenes::CurbSceneOptions& o = scene.options();
  const double middle = 0.5 * (o.left - o.right);
  std::array<std::array<double, kBins>, 2> innermost;  // m from the crown
  for (auto& side : innermost) side.fill(kFar);
  for (const evaluate::CurbFoot& foot : feet) {
    const Eigen::Vector2d at = scene.along_road(foot.at.x, foot.at.y);
    const auto bin = static_cast<int>(std::floor(at.x() / kBinLength));
    if (bin < 0 || bin >= kBins) continue;
    double& inner = innermost[at.y() > middle ? 0 : 1][static_cast<std::size_t>(bin)];
    inner = std::min(inner, std::abs(at.y() - middle));
  }
  const double half = 0.5 * (o.left + o.right);
  const auto is_seen = [&](int bin, int side) {
    for (const double f : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      for (const Eigen::Vector3d& eye : eyes) {
        if (scene.sees_curb(eye, (bin + f) * kBinLength, side)) return true;
      }
    }
    return false;
  };
  BinScore score;
  int right = 0, errors = 0;
  double sum = 0, squares = 0;
  for (int side = 0; side < 2; ++side) {
    for (int bin = 0; bin < kBins; ++bin) {
      const bool seen = scene.has_curbs() && is_seen(bin, side == 0 ? 1 : -1);
      score.bins += seen ? 1 : 0;
      const double error = innermost[static_cast<std::size_t>(side)][static_cast<std::size_t>(bin)] - half;
      if (error > 0.5 * kFar) continue;
      if (std::abs(error) > kRight || !scene.has_curbs()) {
        ++score.wrong;
      } else if (seen) {
        ++right;
      }
      if (std::abs(error) > kCounted || !seen) continue;
      ++errors;
      sum += error;
      squares += error * error;
    }
  }
  score.precision = right + score.wrong > 0 ? static_cast<double>(right) / (right + score.wrong) : 0;
  score.recall = score.bins > 0 ? static_cast<double>(right) / score.bins : 0;
  score.rmse = errors > 0 ? std::sqrt(squares / errors) : 0;
  score.bias = errors > 0 ? sum / errors : 0;
  return score;
}

}  // namespace curbstone::bench::curbs::scores
