#include "services/mapper/shape_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

namespace curbstone {

ShapeLevel::ShapeLevel(const ShapeLevelOptions& options) : options_(options), inverse_size_(1.0 / options.voxel) {}

Eigen::Vector3f ShapeLevel::centre_of(const Eigen::Vector3i& cell) const {
  return ((cell.cast<double>().array() + 0.5) * options_.voxel).cast<float>();
}

void ShapeLevel::insert(const Eigen::Vector3f& point, const Eigen::Vector3f& ray) {
  const Eigen::Vector3i cell = voxel_of(point, inverse_size_);
  const auto next = static_cast<std::uint32_t>(voxels_.size());
  std::uint32_t place = index_.find_or_insert(voxel_key(cell), next);
  if (place == FlatIndex::kNone) {
    place = next;
    voxels_.emplace_back();
    voxels_.back().cell = cell;
  }
  Moments& m = voxels_[place].moments;
  if (m.count >= static_cast<float>(options_.capacity)) return;
  const Eigen::Vector3f d = point - centre_of(cell);
  m.count += 1;
  m.sum += d;
  m.rays += ray;
  m.squares[0] += d.x() * d.x();
  m.squares[1] += d.x() * d.y();
  m.squares[2] += d.x() * d.z();
  m.squares[3] += d.y() * d.y();
  m.squares[4] += d.y() * d.z();
  m.squares[5] += d.z() * d.z();
}

const MapShape* ShapeLevel::shape_at(const Eigen::Vector3f& point, Place& place) {
  const Eigen::Vector3i cell = voxel_of(point, inverse_size_);
  const VoxelKey key = voxel_key(cell);
  if (key != place.key) place = {key, 8, index_.find(key), {}};
  if (place.own != FlatIndex::kNone) return up_to_date(voxels_[place.own]);

  // Beside a surface, not on it: take the neighbour on the nearer side along one axis, nearest first.
  const Eigen::Vector3f d = point - centre_of(cell);
  const unsigned side = (d.x() > 0 ? 1U : 0U) | (d.y() > 0 ? 2U : 0U) | (d.z() > 0 ? 4U : 0U);
  if (side != place.side) {
    place.side = side;
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Vector3i beside = cell;
      beside[axis] += d[axis] > 0 ? 1 : -1;
      place.beside[static_cast<std::size_t>(axis)] = index_.find(voxel_key(beside));
    }
  }
  std::array<int, 3> axes{0, 1, 2};
  const auto order = [&](std::size_t a, std::size_t b) {
    if (std::abs(d[axes[a]]) < std::abs(d[axes[b]])) std::swap(axes[a], axes[b]);
  };
  order(0, 1), order(1, 2), order(0, 1);
  for (const int axis : axes) {
    const std::uint32_t beside = place.beside[static_cast<std::size_t>(axis)];
    if (beside == FlatIndex::kNone) continue;
    if (const MapShape* shape = up_to_date(voxels_[beside])) return shape;
  }
  return nullptr;
}

const MapShape* ShapeLevel::up_to_date(Voxel& voxel) {
  if (voxel.fitted < 0 || version_ - voxel.fitted >= voxel.patience) fit(voxel);
  return voxel.valid ? &voxel.shape : nullptr;
}

void ShapeLevel::fit(Voxel& voxel) {
  double count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Eigen::Vector3f rays = Eigen::Vector3f::Zero();
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dz = -1; dz <= 1; ++dz) {
        const std::uint32_t place = index_.find(voxel_key(voxel.cell + Eigen::Vector3i(dx, dy, dz)));
        if (place == FlatIndex::kNone) continue;
        const Moments& m = voxels_[place].moments;
        const double n = static_cast<double>(m.count);
        const Eigen::Vector3d c = Eigen::Vector3d(dx, dy, dz) * options_.voxel;  // shift of the origin
        const Eigen::Vector3d s = m.sum.cast<double>();
        Eigen::Matrix3d q;
        q << m.squares[0], m.squares[1], m.squares[2], m.squares[1], m.squares[3], m.squares[4], m.squares[2],
            m.squares[4], m.squares[5];
        count += n;
        sum += s + n * c;
        rays += m.rays;
        squares += q + s * c.transpose() + c * s.transpose() + n * c * c.transpose();
      }
    }
  }

  // A neighbourhood that hardly grew is left alone for longer and longer.
  const bool settled = count < 1.1 * static_cast<double>(voxel.fitted_count);
  voxel.patience = settled ? std::min(2 * voxel.patience, 32) : 2;
  voxel.fitted = version_;
  voxel.fitted_count = static_cast<float>(count);
  voxel.valid = false;
  if (count < options_.min_points) return;

  const Eigen::Vector3d mean = sum / count;
  const Eigen::Matrix3d covariance = squares / count - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3d& lambda = solver.eigenvalues();
  const int across = options_.shape == ShapeKind::kPlane ? 0 : 1;
  const double along = lambda[across + 1];
  if (!(along > options_.min_width * options_.min_width && lambda[across] < options_.max_flatness * along)) return;
  voxel.shape.mean = (centre_of(voxel.cell).cast<double>() + mean).cast<float>();
  voxel.shape.axis = solver.eigenvectors().col(options_.shape == ShapeKind::kPlane ? 0 : 2).cast<float>();
  voxel.shape.variance = static_cast<float>(std::max(lambda[across], 0.0));
  voxel.valid = voxel.shape.axis.allFinite();
  if (options_.shape == ShapeKind::kLine) return;
  // Where one ring passes through foliage, or grazes, its returns scatter along the rays: they lie in a plane, and a
  // thin one, but it is the ring's own. Held to it, a vehicle can no longer pitch.
  const float grazing = std::abs(voxel.shape.axis.dot(rays)) / static_cast<float>(count);
  voxel.valid = voxel.valid && grazing > static_cast<float>(options_.min_grazing);
}

void ShapeLevel::keep_around(const Eigen::Vector3f& centre, float radius) {
  const auto far = [&](const Voxel& v) { return (centre_of(v.cell) - centre).cwiseAbs().maxCoeff() > radius; };
  std::erase_if(voxels_, far);
  index_.clear(voxels_.size());
  for (std::size_t i = 0; i < voxels_.size(); ++i) {
    index_.find_or_insert(voxel_key(voxels_[i].cell), static_cast<std::uint32_t>(i));
  }
}

}  // namespace curbstone
