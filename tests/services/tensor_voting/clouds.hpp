#pragma once

#include <Eigen/Core>
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/tensor_voting/kernels/tensor.hpp"
#include "services/tensor_voting/kernels/vote_kernel.hpp"

namespace curbstone::test_clouds {

/// The street on which the peers are compared (docs/benchmarks/voting.md): uniform by area, 1 cm noise. m.
inline std::vector<Eigen::Vector3d> street(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> noise(0, 0.01);
  // Areas: road 20 x 7, two curb faces 20 x 0.15, two pavements 20 x 5.5, two walls 20 x 1.85.
  const double areas[] = {140, 6, 220, 74};
  std::vector<Eigen::Vector3d> points(count);
  for (auto& p : points) {
    double a = unit(random) * 440;
    int part = 0;
    while (a > areas[part] && part < 3) a -= areas[part++];
    const double side = unit(random) < 0.5 ? -1 : 1;
    const double u = unit(random);
    p.x() = -10 + 20 * unit(random);
    if (part == 0) p.y() = -3.5 + 7 * u, p.z() = 0;
    if (part == 1) p.y() = 3.5 * side, p.z() = 0.15 * u;
    if (part == 2) p.y() = side * (3.5 + 5.5 * u), p.z() = 0.15;
    if (part == 3) p.y() = 9 * side, p.z() = 0.15 + 1.85 * u;
    for (int axis = 0; axis < 3; ++axis) p[axis] += noise(random);
  }
  return points;
}

/// The same cloud as the map would hold it: tile by tile, in whole steps, in the order of the cloud.
using Tiles = std::map<TileKey, std::vector<TilePoint>>;
inline Tiles as_tiles(const std::vector<Eigen::Vector3d>& points) {
  Tiles tiles;
  for (const auto& p : points) {
    const auto step = [](double v) { return static_cast<int>(std::floor(v / kPositionStep)); };
    const TileKey key = *tile_at(p.x(), p.y());
    TilePoint point;
    point.x = static_cast<std::int16_t>(std::clamp(step(p.x()) - key.x * kStepsPerTile, 0, kStepsPerTile - 1));
    point.y = static_cast<std::int16_t>(std::clamp(step(p.y()) - key.y * kStepsPerTile, 0, kStepsPerTile - 1));
    point.z = static_cast<std::int16_t>(step(p.z()));
    tiles[key].push_back(point);
  }
  return tiles;
}

inline tensor_voting::kernels::StepPoint in_map(TileKey key, const TilePoint& p, int z_origin = 0) {
  return {key.x * kStepsPerTile + p.x, key.y * kStepsPerTile + p.y, z_origin + p.z};
}

template <class Scalar>
Eigen::Matrix3d matrix(const tensor_voting::kernels::BasicTensor<Scalar>& t) {
  Eigen::Matrix<Scalar, 3, 3> m;
  m << t.xx, t.xy, t.xz, t.xy, t.yy, t.yz, t.xz, t.yz, t.zz;
  return m.template cast<double>();
}

/// |a - b| / |b|, Frobenius.
template <class A, class B>
double relative_difference(const tensor_voting::kernels::BasicTensor<A>& a,
                           const tensor_voting::kernels::BasicTensor<B>& b) {
  return (matrix(a) - matrix(b)).norm() / matrix(b).norm();
}

}  // namespace curbstone::test_clouds
