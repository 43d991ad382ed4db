#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::store {

/// The blobs of the map file (map_store.hpp says what is in them); little-endian on any machine.
[[nodiscard]] std::vector<std::uint8_t> pack_cells(const tile::MapTile& tile);
/// Fills class, height, cost, confidence and hits; false if the blob is invalid.
[[nodiscard]] bool unpack_cells(std::span<const std::uint8_t> blob, tile::MapTile& tile);

[[nodiscard]] std::vector<std::uint8_t> pack_vertices(const std::vector<tile::CurbVertex>& vertices);
[[nodiscard]] std::optional<std::vector<tile::CurbVertex>> unpack_vertices(std::span<const std::uint8_t> blob);

[[nodiscard]] std::vector<std::uint8_t> pack_vertices(const std::vector<tile::MarkingVertex>& vertices);
[[nodiscard]] std::optional<std::vector<tile::MarkingVertex>> unpack_marking_vertices(
    std::span<const std::uint8_t> blob);

}  // namespace curbstone::semantic_map::store
