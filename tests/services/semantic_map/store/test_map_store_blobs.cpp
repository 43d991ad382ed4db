#include "services/semantic_map/store/map_store_blobs.hpp"

#include <gtest/gtest.h>

#include <random>

namespace curbstone::semantic_map::store {
namespace {

TEST(MapStoreBlobs, RefuseWhatIsNotTheirs) {
  tile::MapTile tile;
  const auto cells = pack_cells(tile);
  EXPECT_TRUE(unpack_cells(cells, tile));
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    auto bad = cells;
    if (i % 2 == 0)
      bad.resize(random() % bad.size());
    else
      bad[random() % bad.size()] ^= static_cast<std::uint8_t>(1 + random() % 255);
    tile::MapTile read;
    if (unpack_cells(bad, read)) {
      for (const tile::CellClass c : read.cell_class) EXPECT_LT(static_cast<int>(c), tile::kNumClasses);
    }
  }
  EXPECT_FALSE(unpack_vertices(std::vector<std::uint8_t>(25)));
  EXPECT_FALSE(unpack_vertices(std::vector<std::uint8_t>(24, 0xff)));  // NaN
}

}  // namespace
}  // namespace curbstone::semantic_map::store
