#include "services/semantic_map/tile/voted_tile_packing.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace curbstone::semantic_map::tile {

namespace {

constexpr auto kStep = static_cast<float>(kPositionStep);

using TensorValues = std::array<float, 6>;
TensorValues values_of(const VotedTensor& t) {
  return {t.normal.x(), t.normal.y(), t.normal.z(), t.stick, t.plate, t.mass};
}
void set(const TensorValues& values, VotedTensor& t) {
  t = {{values[0], values[1], values[2]}, values[3], values[4], values[5]};
}
template <std::size_t N>
bool has_same_bits(const std::array<float, N>& a, const std::array<float, N>& b) {
  using Bits = std::array<std::uint32_t, N>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

/// Whether every point takes the tensor of its voter.
bool is_voters_tensor(const VotedTile& tile) {
  if (tile.voters.size() != tile.points.size()) return false;
  for (std::size_t i = 0; i < tile.points.size(); ++i) {
    const std::uint32_t voter = tile.voters[i];
    if (voter > i || !has_same_bits(values_of(tile.points[i]), values_of(tile.points[voter]))) return false;
  }
  return true;
}

using Steps = std::array<std::int16_t, 3>;
using Position = std::array<float, 3>;
/// As take_step() computes it.
Position position_of(const Steps& steps, float z_origin) {
  return {steps[0] * kStep, steps[1] * kStep, z_origin + steps[2] * kStep};
}

std::int16_t steps_in(float length) {
  constexpr float kMost = std::numeric_limits<std::int16_t>::max();
  const float steps = std::round(length / kStep);
  return std::abs(steps) <= kMost ? static_cast<std::int16_t>(steps) : std::int16_t{0};
}

/// Empty if a point does not lie on whole steps.
std::vector<Steps> steps_of(const VotedTile& tile) {
  std::vector<Steps> all;
  all.reserve(tile.points.size());
  for (const VotedPoint& p : tile.points) {
    const Steps steps{steps_in(p.x), steps_in(p.y), steps_in(p.z - tile.z_origin)};
    if (!has_same_bits(position_of(steps, tile.z_origin), {p.x, p.y, p.z})) return {};
    all.push_back(steps);
  }
  return all;
}

}  // namespace

void pack(const VotedTile& tile, ValuePacker& packer) {
  packer.put(tile.key);
  packer.put(tile.utime);
  packer.put(tile.revision);
  packer.put(tile.z_origin);
  packer.put(tile.chain);
  packer.put(tile.intensity);

  std::vector<std::uint32_t> voters;  // how far before the point
  voters.reserve(tile.voters.size());
  for (std::size_t i = 0; i < tile.voters.size(); ++i) voters.push_back(static_cast<std::uint32_t>(i) - tile.voters[i]);
  packer.put(voters);

  const std::vector<Steps> steps = steps_of(tile);
  packer.put(steps);
  std::vector<Position> positions;
  if (steps.empty()) {
    for (const VotedPoint& p : tile.points) positions.push_back({p.x, p.y, p.z});
  }
  packer.put(positions);

  const bool of_voters = is_voters_tensor(tile);
  std::vector<TensorValues> tensors;
  for (std::size_t i = 0; i < tile.points.size(); ++i) {
    if (!of_voters || tile.voters[i] == i) tensors.push_back(values_of(tile.points[i]));
  }
  packer.put(of_voters);
  packer.put(tensors);
}

VotedTile unpack_voted_tile(ValueUnpacker& unpacker) {
  VotedTile tile;
  tile.key = unpacker.take<TileKey>();
  tile.utime = unpacker.take<std::int64_t>();
  tile.revision = unpacker.take<std::int32_t>();
  tile.z_origin = unpacker.take<float>();
  tile.chain = unpacker.take<std::int64_t>();
  unpacker.take(tile.intensity);
  unpacker.take(tile.voters);
  for (std::size_t i = 0; i < tile.voters.size(); ++i) tile.voters[i] = static_cast<std::uint32_t>(i) - tile.voters[i];

  std::vector<Steps> steps;
  std::vector<Position> positions;
  unpacker.take(steps);
  unpacker.take(positions);
  for (const Steps& s : steps) positions.push_back(position_of(s, tile.z_origin));
  const auto of_voters = unpacker.take<bool>();
  std::vector<TensorValues> tensors;
  unpacker.take(tensors);

  tile.points.resize(positions.size());
  auto tensor = tensors.begin();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    VotedPoint& p = tile.points[i];
    if (of_voters && tile.voters[i] < i) {
      static_cast<VotedTensor&>(p) = tile.points[tile.voters[i]];
    } else {
      set(*tensor++, p);
    }
    p.x = positions[i][0], p.y = positions[i][1], p.z = positions[i][2];
  }
  return tile;
}

}  // namespace curbstone::semantic_map::tile
