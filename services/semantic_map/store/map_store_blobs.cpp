#include "services/semantic_map/store/map_store_blobs.hpp"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace curbstone::semantic_map::store {

namespace {

constexpr std::size_t kPlain =
    6 * tile::kCellsInTile;  // class, height (2 bytes), cost, confidence (difference from the expected value), hits
constexpr std::size_t kPlain1 = 5 * tile::kCellsInTile;  // as schema 1 has it: without hits
constexpr int kLevel = 6;

void append(float value, std::vector<std::uint8_t>& blob) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  for (int shift = 0; shift < 32; shift += 8) blob.push_back(static_cast<std::uint8_t>(bits >> shift));
}

/// visit(values) of each `kFloats` floats. False if the blob is no whole number of them, or one is not finite.
template <std::size_t kFloats, class Visit>
bool for_rows(std::span<const std::uint8_t> blob, Visit visit) {
  if (blob.size() % (kFloats * 4) != 0) return false;
  for (std::size_t row = 0; row < blob.size(); row += kFloats * 4) {
    std::array<float, kFloats> values{};
    for (std::size_t k = 0; k < kFloats; ++k) {
      const std::uint8_t* b = &blob[row + k * 4];
      values[k] = std::bit_cast<float>(std::uint32_t{b[0]} | std::uint32_t{b[1]} << 8 | std::uint32_t{b[2]} << 16 |
                                       std::uint32_t{b[3]} << 24);
      if (!std::isfinite(values[k])) return false;
    }
    visit(values);
  }
  return true;
}

int expected_confidence(std::uint8_t hits) {
  return std::min(255, 32 * hits);
}

}  // namespace

std::vector<std::uint8_t> pack_cells(const tile::MapTile& tile) {
  std::vector<std::uint8_t> plain;
  plain.reserve(kPlain);
  for (const tile::CellClass c : tile.cell_class) plain.push_back(static_cast<std::uint8_t>(c));
  // Low bytes, then high bytes: the latter are nearly all the same and compress to nothing.
  for (const std::int16_t h : tile.height)
    plain.push_back(static_cast<std::uint8_t>(static_cast<std::uint16_t>(h) & 0xff));
  for (const std::int16_t h : tile.height)
    plain.push_back(static_cast<std::uint8_t>(static_cast<std::uint16_t>(h) >> 8));
  plain.insert(plain.end(), tile.cost.begin(), tile.cost.end());
  // The confidence is mostly the value expected from the hits, so the difference is mostly 0.
  for (std::size_t i = 0; i < tile::kCellsInTile; ++i)
    plain.push_back(static_cast<std::uint8_t>(expected_confidence(tile.hits[i]) - tile.confidence[i]));
  plain.insert(plain.end(), tile.hits.begin(), tile.hits.end());

  uLongf size = compressBound(kPlain);
  std::vector<std::uint8_t> packed(size);
  compress2(packed.data(), &size, plain.data(), kPlain, kLevel);  // cannot fail: the buffer is as large as it takes
  packed.resize(size);
  return packed;
}

bool unpack_cells(std::span<const std::uint8_t> blob, tile::MapTile& tile) {
  std::array<std::uint8_t, kPlain> plain{};
  uLongf size = kPlain;
  if (uncompress(plain.data(), &size, blob.data(), blob.size()) != Z_OK) return false;
  if (size != kPlain && size != kPlain1) return false;
  for (std::size_t i = 0; i < tile::kCellsInTile; ++i) {
    if (plain[i] >= tile::kNumClasses) return false;
    tile.cell_class[i] = static_cast<tile::CellClass>(plain[i]);
    tile.height[i] =
        static_cast<std::int16_t>(plain[tile::kCellsInTile + i] | (plain[2 * tile::kCellsInTile + i] << 8));
    tile.cost[i] = plain[3 * tile::kCellsInTile + i];
    tile.hits[i] = plain[5 * tile::kCellsInTile + i];  // schema 1: 0
    const std::uint8_t confidence = plain[4 * tile::kCellsInTile + i];
    tile.confidence[i] =
        size == kPlain1 ? confidence : static_cast<std::uint8_t>(expected_confidence(tile.hits[i]) - confidence);
  }
  return true;
}

std::vector<std::uint8_t> pack_vertices(const std::vector<tile::CurbVertex>& vertices) {
  std::vector<std::uint8_t> blob;
  for (const tile::CurbVertex& v : vertices) {
    for (const float value : {v.x, v.y, v.z, v.height, v.high_side_x, v.high_side_y}) append(value, blob);
  }
  return blob;
}

std::optional<std::vector<tile::CurbVertex>> unpack_vertices(std::span<const std::uint8_t> blob) {
  std::vector<tile::CurbVertex> vertices;
  const bool is_sound = for_rows<6>(blob, [&](const std::array<float, 6>& v) {
    vertices.push_back({v[0], v[1], v[2], v[3], v[4], v[5]});
  });
  if (!is_sound) return std::nullopt;
  return vertices;
}

std::vector<std::uint8_t> pack_vertices(const std::vector<tile::MarkingVertex>& vertices) {
  std::vector<std::uint8_t> blob;
  for (const tile::MarkingVertex& v : vertices) {
    for (const float value : {v.x, v.y, v.z, v.painted ? 1.0F : 0.0F}) append(value, blob);
  }
  return blob;
}

std::optional<std::vector<tile::MarkingVertex>> unpack_marking_vertices(std::span<const std::uint8_t> blob) {
  std::vector<tile::MarkingVertex> vertices;
  const bool is_sound = for_rows<4>(blob, [&](const std::array<float, 4>& v) {
    vertices.push_back({v[0], v[1], v[2], v[3] != 0});
  });
  if (!is_sound) return std::nullopt;
  return vertices;
}

}  // namespace curbstone::semantic_map::store
