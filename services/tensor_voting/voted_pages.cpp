#include "services/tensor_voting/voted_pages.hpp"

#include <algorithm>
#include <cmath>

#include "services/tensor_voting/decomposition.hpp"

namespace curbstone {

namespace {

/// A decomposition as the message carries it.
struct WireTensor {
  std::int16_t normal[3];
  std::int8_t tangent[3];
  std::uint8_t stick;
  std::uint8_t plate;
  float mass;
};

WireTensor to_wire(const DecompositionF& d) {
  WireTensor wire;
  for (int axis = 0; axis < 3; ++axis) {
    wire.normal[axis] = static_cast<std::int16_t>(std::lround(d.normal[axis] * 32767));
    wire.tangent[axis] = static_cast<std::int8_t>(std::lround(d.tangent[axis] * 127));
  }
  wire.stick = static_cast<std::uint8_t>(std::lround(d.stick * 255));
  wire.plate = static_cast<std::uint8_t>(std::lround(d.plate * 255));
  wire.mass = d.mass;
  return wire;
}

std::vector<WireTensor> tensors_of_voters(const VotingField& field, TileKey key) {
  std::vector<TensorF> tensors;
  for (const VoteSums& sums : field.sums(key)) tensors.push_back(to_float(to_tensor(sums, field.parameters().ball)));
  std::vector<WireTensor> wires;
  wires.reserve(tensors.size());
  for (const DecompositionF& d : decompose(tensors)) wires.push_back(to_wire(d));
  return wires;
}

void append(voted_points_t& page, const WireTensor& wire) {
  page.normal_x.push_back(wire.normal[0]);
  page.normal_y.push_back(wire.normal[1]);
  page.normal_z.push_back(wire.normal[2]);
  page.tangent_x.push_back(wire.tangent[0]);
  page.tangent_y.push_back(wire.tangent[1]);
  page.tangent_z.push_back(wire.tangent[2]);
  page.stick.push_back(wire.stick);
  page.plate.push_back(wire.plate);
  page.mass.push_back(wire.mass);
}

}  // namespace

std::vector<voted_points_t> make_voted_pages(TileKey key, const PointTile& tile, std::int32_t epoch,
                                             std::int32_t revision, std::int64_t utime,
                                             std::span<const VotingField> fields) {
  constexpr std::size_t kPointBytes = 3 * sizeof(std::int16_t) + 1;
  constexpr std::size_t kTensorBytes = 3 * sizeof(std::int16_t) + 3 + 2 + sizeof(float);
  constexpr std::size_t kHeaderBytes = 200;
  const std::size_t per_page = (kMaxPageBytes - kHeaderBytes) / (kPointBytes + kTensorBytes * fields.size());

  std::vector<std::vector<WireTensor>> tensors;
  for (const VotingField& field : fields) tensors.push_back(tensors_of_voters(field, key));

  std::vector<voted_points_t> pages;
  for (std::size_t first = 0; first < tile.points.size(); first += per_page) {
    const std::size_t last = std::min(first + per_page, tile.points.size());
    voted_points_t& page = pages.emplace_back();
    page.utime = utime;
    page.epoch = epoch;
    page.tile_x = key.x;
    page.tile_y = key.y;
    page.z_origin = static_cast<float>(tile.z_origin);
    page.revision = revision;
    page.total = static_cast<std::int32_t>(tile.points.size());
    page.first = static_cast<std::int32_t>(first);
    page.num_points = static_cast<std::int32_t>(last - first);
    for (std::size_t i = first; i < last; ++i) {
      page.x.push_back(tile.points[i].x);
      page.y.push_back(tile.points[i].y);
      page.z.push_back(tile.points[i].z);
      page.intensity.push_back(tile.points[i].intensity);
    }
    page.num_scales = static_cast<std::int8_t>(fields.size());
    page.num_tensors = page.num_points * page.num_scales;
    for (std::size_t scale = 0; scale < fields.size(); ++scale) {
      page.sigma.push_back(static_cast<float>(fields[scale].parameters().sigma));
      const auto voters = fields[scale].voters_of_points(key);
      for (std::size_t i = first; i < last; ++i) append(page, tensors[scale][voters[i]]);
    }
  }
  return pages;
}

}  // namespace curbstone
