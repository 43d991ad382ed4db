#include "services/semantic_map/curb_lines/lowered_step.hpp"

#include <array>
#include <cmath>
#include <span>

#include "common/linear/decompositions.hpp"

namespace curbstone::semantic_map::curb_lines {

namespace {

constexpr double kSeenShare = 0.6;   // of the line, seen on both sides
constexpr double kHalfAsMuch = 0.5;  // step of each half of the line, relative to the whole
constexpr int kParameters = 6;
constexpr int kMinSamples = 24;
constexpr double kNoiseFloor = 0.004;                      // m: least scatter of the cells' heights
constexpr std::array kOffsets = {0.14, 0.26, 0.38, 0.50};  // m, a cell apart

struct Sample {
  double t = 0, u = 0, z = 0;
};

using Row = Eigen::Matrix<double, kParameters, 1>;

std::optional<LoweredStep> fit(std::span<const Sample> samples) {
  if (samples.size() < kMinSamples) return std::nullopt;
  double middle = 0;
  for (const Sample& s : samples) middle += s.t;
  middle /= static_cast<double>(samples.size());
  const auto row = [&](const Sample& s) {
    const double t = s.t - middle;
    return s.u < 0 ? Row(1, t, t * t, s.u, 0, 0) : Row(1, t, t * t, 0, s.u, 1);
  };
  Eigen::Matrix<double, kParameters, kParameters> normal = Eigen::Matrix<double, kParameters, kParameters>::Zero();
  Row right = Row::Zero();
  for (const Sample& s : samples) {
    const Row r = row(s);
    normal += r * r.transpose();
    right += r * s.z;
  }
  const Ldlt<kParameters> solver(normal);
  if (!(solver.least_pivot() > 1e-6)) return std::nullopt;
  const Row found = solver.solve(right);
  double rest = 0;
  for (const Sample& s : samples) rest += std::pow(s.z - row(s).dot(found), 2);
  const double noise2 = rest / static_cast<double>(samples.size() - kParameters) + kNoiseFloor * kNoiseFloor;
  const double variance = solver.solve(Row::Unit(kParameters - 1))(kParameters - 1);
  return LoweredStep{found(kParameters - 1), std::sqrt(noise2 * variance)};
}

}  // namespace

std::optional<LoweredStep> find_lowered_step(const SeenGround& ground, const std::vector<tile::CurbVertex>& line) {
  std::vector<Sample> samples;
  std::size_t seen = 0;
  std::size_t half = 0;
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (2 * k <= line.size()) half = samples.size();
    const tile::CurbVertex& v = line[k];
    const Eigen::Vector2d at(double{v.x}, double{v.y});
    const Eigen::Vector2d up(double{v.high_side_x}, double{v.high_side_y});
    const double t = (at - Eigen::Vector2d(double{line.front().x}, double{line.front().y})).norm();
    const std::size_t first = samples.size();
    int low = 0;
    for (const double off : kOffsets) {
      if (const auto z = ground(at - off * up)) {
        samples.push_back({t, -off, *z - double{line.front().z}});
        ++low;
      }
    }
    const std::size_t first_high = samples.size();
    for (const double off : kOffsets) {
      if (const auto z = ground(at + off * up)) samples.push_back({t, off, *z - double{line.front().z}});
    }
    if (low == 0 || samples.size() == first_high)
      samples.resize(first);
    else
      ++seen;
  }
  if (static_cast<double>(seen) < kSeenShare * static_cast<double>(line.size())) return std::nullopt;
  const std::span<const Sample> all(samples);
  const auto whole = fit(all);
  if (!whole || samples.size() < 2 * kMinSamples) return whole;
  for (const auto& part : {fit(all.first(half)), fit(all.subspan(half))}) {
    if (!part || part->height < kHalfAsMuch * whole->height) return std::nullopt;
  }
  return whole;
}

}  // namespace curbstone::semantic_map::curb_lines
