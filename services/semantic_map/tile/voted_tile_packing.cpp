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
VotedTensor tensor_of(const TensorValues& values) {
  return {{values[0], values[1], values[2]}, values[3], values[4], values[5]};
}
template <std::size_t N>
bool has_same_bits(const std::array<float, N>& a, const std::array<float, N>& b) {
  using Bits = std::array<std::uint32_t, N>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

using Steps = std::array<std::int16_t, 3>;
using Position = std::array<float, 3>;
/// Computed as in take_step(), so that the bits are the same.
Position position_of(const Steps& steps, float z_origin) {
  return {steps[0] * kStep, steps[1] * kStep, z_origin + steps[2] * kStep};
}

std::int16_t steps_in(float length) {
  constexpr float kMaxSteps = std::numeric_limits<std::int16_t>::max();
  const float steps = std::round(length / kStep);
  return std::abs(steps) <= kMaxSteps ? static_cast<std::int16_t>(steps) : std::int16_t{0};
}

/// The positions in steps of kPositionStep; empty if a point does not lie on whole steps.
std::vector<Steps> steps_of(const VotedTile& tile) {
  std::vector<Steps> all;
  all.reserve(tile.points.size());
  for (const VotedPoints::Place& p : tile.points.places()) {
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

  const std::vector<Steps> steps = steps_of(tile);
  packer.put(steps);
  std::vector<Position> positions;
  if (steps.empty()) {
    for (const VotedPoints::Place& p : tile.points.places()) positions.push_back({p.x, p.y, p.z});
  }
  packer.put(positions);

  // For each point: how many tensors ago its tensor was first used; 0: this point is the first to use it.
  std::vector<std::uint32_t> back;
  back.reserve(tile.points.size());
  std::vector<TensorValues> tensors;
  for (const VotedPoints::Place& p : tile.points.places()) {
    back.push_back(static_cast<std::uint32_t>(tensors.size()) - p.tensor);
    if (back.back() == 0) tensors.push_back(values_of(tile.points.tensors()[p.tensor]));
  }
  packer.put(back);
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

  std::vector<Steps> steps;
  std::vector<Position> positions;
  unpacker.take(steps);
  unpacker.take(positions);
  for (const Steps& s : steps) positions.push_back(position_of(s, tile.z_origin));
  std::vector<std::uint32_t> back;
  std::vector<TensorValues> tensors;
  unpacker.take(back);
  unpacker.take(tensors);

  tile.points.make_room(positions.size());
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const auto& [x, y, z] = positions[i];
    if (back[i] == 0) {
      tile.points.push_back(VotedPoint{tensor_of(tensors[next++]), x, y, z});
    } else {
      tile.points.append(VotedPoints::Place{x, y, z, next - back[i]});
    }
  }
  return tile;
}

}  // namespace curbstone::semantic_map::tile
