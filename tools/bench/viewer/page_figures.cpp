#include "tools/bench/viewer/page_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <utility>

#include "common/time/clock.hpp"
#include "tools/bench/viewer/live_page.hpp"

namespace curbstone::bench::viewer {
namespace {

constexpr int kAside = 139;                   // tiles: 12.1 million cells
constexpr int kOpened = 5;                    // page loads for the median of the first picture
constexpr std::int64_t kTilePeriod = 50'000;  // us
constexpr double kWatched = 12;               // s of tiles; the viewer keeps the last 64 frames
constexpr std::pair<const char*, const char*> kViews[] = {
    {"whole", "scale: 1.6, tilt: 0"}, {"near", "scale: 14, tilt: 0"}, {"tilted", "scale: 14, tilt: 0.96"}};

std::string has_drawn(std::size_t tiles) {
  return fmt::format("curbstone.world.tiles.size >= {} && curbstone.world.changed.size === 0", tiles);
}

/// ms from the request for the page until the whole map is drawn: readPixels returns only after all earlier drawing.
double first_picture(LivePage& page, std::size_t tiles) {
  page.open("follow=0&theme=light");
  // performance.now() counts from the request.
  return page.evaluate(fmt::format(
      "new Promise(done => {{ const look = () => {{ if (typeof curbstone !== 'object' || !({})) return "
      "setTimeout(look, "
      "2); const gl = document.getElementById('ground').getContext('webgl2'); "
      "gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); done(performance.now()); }}; look(); "
      "}})",
      has_drawn(tiles)));
}

void measure_map(const std::vector<semantic_tile_t>& map, nlohmann::json& figures) {
  LivePage page;
  for (const semantic_tile_t& tile : map) page.put(tile);
  // The first page of a browser also waits for the browser's processes and for the first WebGL context.
  figures["first_picture_cold_ms"] = first_picture(page, map.size());
  std::vector<double> pictures(kOpened);
  for (double& picture : pictures) picture = first_picture(page, map.size());
  std::nth_element(pictures.begin(), pictures.begin() + kOpened / 2, pictures.end());
  figures["first_picture_warm_ms"] = pictures[kOpened / 2];
  std::int64_t said = 0;
  std::size_t next = 0;
  page.meanwhile = [&] {
    const std::int64_t now = wall_clock();
    if (now - said < kTilePeriod) return;
    said = now;
    page.put(map[next++ % map.size()]);
  };
  page.pass(kWatched);
  figures["screen_ms"] = {{"p50", 1e3 * page.evaluate("curbstone.world.state.latency[0]")},
                          {"p95", 1e3 * page.evaluate("curbstone.world.state.latency[1]")}};
}

/// Hills with random roads, walls and unknown cells.
semantic_tile_t made_tile(int x, int y, std::mt19937& random) {
  semantic_tile_t tile{};
  tile.tile_x = x;
  tile.tile_y = y;
  tile.z_origin = 2 * std::sin(0.2F * static_cast<float>(x)) * std::cos(0.17F * static_cast<float>(y));
  std::discrete_distribution<int> classes({10, 80, 2, 3, 5});
  for (int i = 0; i < 625; ++i) {
    tile.cell_class[i] = static_cast<std::uint8_t>(classes(random));
    tile.height[i] = static_cast<std::int16_t>(random() % 20);
  }
  return tile;
}

void measure_large_map(nlohmann::json& figures) {
  LivePage page;
  std::mt19937 random(7);
  for (int y = 0; y < kAside; ++y)
    for (int x = 0; x < kAside; ++x) page.put(made_tile(x - kAside / 2, y - kAside / 2, random));
  figures["cells"] = kAside * kAside * 625;
  page.open("at=0,0,14,0&follow=0&theme=light&off=grid");  // cells are not drawn while they arrive
  page.wait_for("typeof curbstone === 'object' && " + has_drawn(kAside * kAside));
  (void)page.evaluate("+(curbstone.settings.layers.grid = true)");
  // Draws the whole map once so that all cells are painted; turning it then paints none.
  (void)page.evaluate(
      "new Promise(done => { Object.assign(curbstone.camera, { scale: 1.6, tilt: 0 }); curbstone.redraw(); "
      "setTimeout(() => done(0), 5000); })");
  for (const auto& [name, view] : kViews) {
    figures["frames_per_s"][name] = page.evaluate(fmt::format(
        "new Promise(done => {{ let n = -3, begin = 0; Object.assign(curbstone.camera, {{ {} }}); "
        "const step = () => {{ if (++n === 0) begin = performance.now(); "
        "curbstone.camera.turn += 0.002; curbstone.redraw(); const ms = performance.now() - begin; "
        "n < 1 || ms < 5000 ? requestAnimationFrame(step) : done(1000 * n / ms); }}; requestAnimationFrame(step); }})",
        view));
  }
}

}  // namespace

nlohmann::json measure_pages(const std::vector<semantic_tile_t>& map) {
  nlohmann::json figures;
  measure_map(map, figures);
  measure_large_map(figures);
  return figures;
}

}  // namespace curbstone::bench::viewer
