#include <cstdio>
#include <curbstone/semantic_tile_t.hpp>
#include <lcm/lcm-cpp.hpp>

int main() {
  lcm::LCM bus("memq://");
  curbstone::semantic_tile_t tile{};
  tile.cell_class[0] = curbstone::semantic_tile_t::CURB;
  if (!bus.good() || bus.publish("SEMANTIC_TILE", &tile) != 0) return 1;
  std::puts("planner: understands SEMANTIC_TILE");
  return 0;
}
