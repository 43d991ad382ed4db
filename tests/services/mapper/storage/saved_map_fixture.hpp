#pragma once

#include <filesystem>
#include <string>

#include "services/mapper/storage/saved_map.hpp"

namespace curbstone::mapper::storage {

/// A map of `tiles` tiles and `nodes` nodes of random points, poses, edges; the same for the same seed.
[[nodiscard]] SavedMap random_map(unsigned seed, int tiles, int nodes);

/// Bit for bit; the order of everything included.
[[nodiscard]] bool equal(const SavedMap& a, const SavedMap& b);

[[nodiscard]] std::string bytes_of(const std::filesystem::path& file);
void put_bytes(const std::filesystem::path& file, const std::string& bytes);

}  // namespace curbstone::mapper::storage
