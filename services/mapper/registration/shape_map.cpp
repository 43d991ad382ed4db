#include "services/mapper/registration/shape_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/linear/decompositions.hpp"

namespace curbstone::mapper::registration {
ShapeLevel::ShapeLevel(const ShapeLevelOptions& options) : options_(options), inverse_size_(1.0 / options.voxel) {}

Eigen::Vector3d ShapeLevel::centre_of(const Eigen::Vector3i& cell) const {
  return (cell.cast<double>().array() + 0.5) * options_.voxel;
}

std::uint32_t ShapeLevel::new_voxel() {
  if (free_.empty()) {
    moments_.emplace_back();
    fitted_.emplace_back();
    return static_cast<std::uint32_t>(moments_.size() - 1);
  }
  const std::uint32_t voxel = free_.back();
  free_.pop_back();
  moments_[voxel] = {};
  fitted_[voxel] = {};
  return voxel;
}

void ShapeLevel::insert(std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector3f> rays) {
  std::array<Place, kTogether> places;
  for (std::size_t begin = 0; begin < points.size(); begin += kTogether) {
    const auto now = points.subspan(begin, std::min(kTogether, points.size() - begin));
    search(now, places);
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (places[i].voxel != voxels::BlockIndex::kNone) __builtin_prefetch(&moments_[places[i].voxel], 1);
    }
    for (std::size_t i = 0; i < now.size(); ++i) add(now[i], rays[begin + i], places[i]);
  }
}

void ShapeLevel::add(const Eigen::Vector3d& point, const Eigen::Vector3f& ray, Place place) {
  if (place.voxel == voxels::BlockIndex::kNone) {  // or a point before this one has made it
    std::uint32_t& voxel = index_.place(place.cell);
    if (voxel == voxels::BlockIndex::kNone) voxel = new_voxel();
    place.voxel = voxel;
  }
  Moments& m = moments_[place.voxel];
  if (m.first[0] >= static_cast<float>(options_.capacity)) return;
  const Eigen::Vector3f d = (point - centre_of(place.cell)).cast<float>();
  m.first += Eigen::Array4f(1, d.x(), d.y(), d.z());
  m.squares += Eigen::Array4f(d.x() * d.x(), d.y() * d.y(), d.z() * d.z(), d.x() * d.y());
  m.rest += Eigen::Array4f(d.x() * d.z(), d.y() * d.z(), ray.x(), ray.y());
  m.rays_z += ray.z();
  if (notes_changes_ && !std::exchange(m.is_noted, true)) changed_.push_back(place.cell);
}

void ShapeLevel::search(std::span<const Eigen::Vector3d> points, std::span<Place> places) const {
  std::array<std::uint32_t, kTogether> blocks;
  for (std::size_t i = 0; i < points.size(); ++i) {
    places[i].cell = voxels::voxel_of(points[i], inverse_size_);
    __builtin_prefetch(index_.begin_of_search(places[i].cell));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    blocks[i] = index_.block(places[i].cell);
    __builtin_prefetch(index_.address_in(blocks[i], places[i].cell));
  }
  for (std::size_t i = 0; i < points.size(); ++i) places[i].voxel = index_.find_in(blocks[i], places[i].cell);
}

void ShapeLevel::find(std::span<const Eigen::Vector3d> points, std::span<Place> places) const {
  search(points, places);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (places[i].voxel != voxels::BlockIndex::kNone) __builtin_prefetch(&fitted_[places[i].voxel]);
  }
}

const MapShape* ShapeLevel::shape_at(const Eigen::Vector3d& point) {
  Place place;
  find({&point, 1}, {&place, 1});
  return shape_at(point, place);
}

const MapShape* ShapeLevel::shape_at(const Eigen::Vector3d& point, const Place& place) {
  const Eigen::Vector3i& cell = place.cell;
  if (place.voxel != voxels::BlockIndex::kNone) return up_to_date(place.voxel, cell);

  // The point is beside a surface, not on it: take the neighbour on the nearer side along one axis, nearest axis first.
  voxels::BlockIndex::Finder find(index_);
  const Eigen::Vector3d d = point - centre_of(cell);
  std::array<int, 3> axes{0, 1, 2};
  const auto order = [&](std::size_t a, std::size_t b) {
    if (std::abs(d[axes[a]]) < std::abs(d[axes[b]])) std::swap(axes[a], axes[b]);
  };
  order(0, 1), order(1, 2), order(0, 1);
  for (const int axis : axes) {
    Eigen::Vector3i beside = cell;
    beside[axis] += d[axis] > 0 ? 1 : -1;
    const std::uint32_t voxel = find(beside);
    if (voxel == voxels::BlockIndex::kNone) continue;
    if (const MapShape* shape = up_to_date(voxel, beside)) return shape;
  }
  return nullptr;
}

const MapShape* ShapeLevel::up_to_date(std::uint32_t voxel, const Eigen::Vector3i& cell) {
  Fitted& fitted = fitted_[voxel];
  if (fitted.version < 0 || version_ - fitted.version >= fitted.patience) fit(fitted, cell);
  return fitted.valid ? &fitted.shape : nullptr;
}

/// The offset of a voxel from the middle one of 3 x 3 x 3, and its products, four alike where they multiply sums.
struct ShapeLevel::Offset {
  explicit Offset(std::size_t number)
      : Offset(static_cast<float>(number / 9) - 1, static_cast<float>(number / 3 % 3) - 1,
               static_cast<float>(number % 3) - 1) {}
  Eigen::Array4f x, y, z;
  Eigen::Array4f products, mixed_products;  // xx yy zz xy; xz yz

 private:
  Offset(float dx, float dy, float dz)
      : x(Eigen::Array4f::Constant(dx)),
        y(Eigen::Array4f::Constant(dy)),
        z(Eigen::Array4f::Constant(dz)),
        products(dx * dx, dy * dy, dz * dz, dx * dy),
        mixed_products(dx * dz, dy * dz, 0, 0) {}
};

/// Sums over a 3 x 3 x 3 neighbourhood of voxels. Each voxel's moments are about its own centre, which is -1, 0 or 1
/// voxel sides from the middle one in each axis. Shifting them to the middle voxel's centre therefore takes only the
/// differences of the sums on either side, and the counts there.
struct ShapeLevel::Neighbourhood {
  Eigen::Array4f first = Eigen::Array4f::Zero(), squares = first, rest = first;
  Eigen::Array4f along_x = first, along_y = first, along_z = first;
  Eigen::Array4f counts = first, mixed_counts = first;
  float rays_z = 0;

  void add(const Moments& m, const Offset& offset) {
    first += m.first;
    squares += m.squares;
    rest += m.rest;
    rays_z += m.rays_z;
    along_x += offset.x * m.first;
    along_y += offset.y * m.first;
    along_z += offset.z * m.first;
    counts += m.first[0] * offset.products;
    mixed_counts += m.first[0] * offset.mixed_products;
  }

  struct Distribution {
    Eigen::Vector3d mean;  ///< m from the middle voxel's centre
    Eigen::Matrix3d covariance;
  };
  /// `h`: m, side of a voxel.
  [[nodiscard]] Distribution distribution(double h) const {
    const double h2 = h * h;
    const auto count = static_cast<double>(first[0]);
    const Eigen::Array4d n = first.cast<double>(), q = squares.cast<double>(), r = rest.cast<double>();
    const Eigen::Array4d ax = h * along_x.cast<double>(), ay = h * along_y.cast<double>(),
                         az = h * along_z.cast<double>();
    const Eigen::Array4d c = h2 * counts.cast<double>(), cm = h2 * mixed_counts.cast<double>();
    const Eigen::Vector3d mean = Eigen::Vector3d(n[1] + ax[0], n[2] + ay[0], n[3] + az[0]) / count;
    const double xy = q[3] + ax[2] + ay[1] + c[3];
    const double xz = r[0] + ax[3] + az[1] + cm[0];
    const double yz = r[1] + ay[3] + az[2] + cm[1];
    Eigen::Matrix3d about_centre;
    about_centre << q[0] + 2 * ax[1] + c[0], xy, xz, xy, q[1] + 2 * ay[2] + c[1], yz, xz, yz, q[2] + 2 * az[3] + c[2];
    return {mean, about_centre / count - mean * mean.transpose()};
  }
};

void ShapeLevel::fit(Fitted& fitted, const Eigen::Vector3i& cell) const {
  static const std::array<Offset, 27> kOffsets = [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<Offset, 27>{Offset(I)...};
  }
  (std::make_index_sequence<27>());
  // All voxels are fetched before the first one is read.
  std::array<std::uint32_t, 27> voxels;
  std::array<std::uint8_t, 27> offsets;
  std::size_t size = 0;
  index_.around(cell, [&](std::uint32_t voxel, int dx, int dy, int dz) {
    __builtin_prefetch(&moments_[voxel]);
    voxels[size] = voxel;
    offsets[size++] = static_cast<std::uint8_t>(9 * dx + 3 * dy + dz + 13);
  });
  Neighbourhood sum;
  for (std::size_t i = 0; i < size; ++i) sum.add(moments_[voxels[i]], kOffsets[offsets[i]]);
  const auto count = static_cast<double>(sum.first[0]);

  // A neighbourhood that hardly grew is refitted at ever longer intervals.
  const bool settled = count < 1.1 * static_cast<double>(fitted.count);
  fitted.patience = static_cast<std::int16_t>(settled ? std::min(2 * fitted.patience, 32) : 2);
  fitted.version = version_;
  fitted.count = sum.first[0];
  fitted.valid = false;
  if (count < options_.min_points) return;

  const auto [mean, covariance] = sum.distribution(options_.voxel);
  const auto [lambda, axes] = eigen_pairs_direct(covariance);
  const int across = options_.shape == ShapeKind::kPlane ? 0 : 1;
  const double along = lambda[across + 1];
  if (!(along > options_.min_width * options_.min_width && lambda[across] < options_.max_flatness * along)) return;
  fitted.shape.mean = centre_of(cell) + mean;
  fitted.shape.axis = axes.col(options_.shape == ShapeKind::kPlane ? 0 : 2).cast<float>();
  fitted.shape.variance = static_cast<float>(std::max(lambda[across], 0.0));
  fitted.valid = fitted.shape.axis.allFinite();
  if (options_.shape == ShapeKind::kLine) return;
  // Where a single ring passes through foliage or grazes a surface, its returns scatter along the rays. They lie in a
  // thin plane, but it is the plane of the ring. As a constraint it would freeze the pitch.
  const Eigen::Vector3f rays(sum.rest[2], sum.rest[3], sum.rays_z);
  const float grazing = std::abs(fitted.shape.axis.dot(rays)) / sum.first[0];
  fitted.valid = fitted.valid && grazing > static_cast<float>(options_.min_grazing);
}

void ShapeLevel::keep_around(const Eigen::Vector3d& centre, double radius) {
  const auto far = [&](const Eigen::Vector3i& middle) {
    return (middle.cast<double>() * options_.voxel - centre).cwiseAbs().maxCoeff() > radius;
  };
  index_.erase_blocks(far, [&](std::uint32_t voxel) { free_.push_back(voxel); });
}

}  // namespace curbstone::mapper::registration
