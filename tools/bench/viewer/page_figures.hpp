#pragma once

#include <curbstone/semantic_tile_t.hpp>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace curbstone::bench::viewer {

/// Measures how soon and how often a page draws, in Chromium without a graphics card:
///   first_picture_ms         from the request for the page to the whole map on the screen
///   screen_ms: p50, p95      from a tile on the bus to the screen, 20 tiles per second
///   frames_per_s: VIEW       of `cells` cells, while turning: the whole map from above, near, tilted
/// Throws std::runtime_error.
[[nodiscard]] nlohmann::json measure_pages(const std::vector<semantic_tile_t>& map);

}  // namespace curbstone::bench::viewer
