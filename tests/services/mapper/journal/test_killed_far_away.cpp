#include <gmock/gmock.h>

#include <map>
#include <utility>

#include "tests/services/mapper/journal/killed_mapper.hpp"
#include "tests/services/mapper/round_street.hpp"

namespace curbstone::mapper::journal {
namespace {

using ::testing::IsEmpty;
using Records = std::map<TileKey, dense_map::TileRecords>;

/// Most of what its mapper knows lies in the file of far tiles.
class KilledFarAwayTest : public KilledMapperTest {
 protected:
  KilledFarAwayTest() {
    world_ = test::round_street();
    trajectory_ = test::around;
    test::keep_little_in_memory(config_, folder_.path().string());
  }
  [[nodiscard]] Records records() const {
    Records all;
    const dense_map::DenseMap& map = node_->mapper().grown();
    for (const TileKey& key : map.keys()) {
      dense_map::TileRecords records = *map.tile(key)->read();
      if (!records.records.empty()) all.emplace(key, std::move(records));
    }
    return all;
  }
  [[nodiscard]] int num_away() const {
    const dense_map::DenseMap& map = node_->mapper().grown();
    int spilled = 0;
    for (const TileKey& key : map.keys()) spilled += map.tile(key)->is_spilled() ? 1 : 0;
    return spilled;
  }
};

TEST_F(KilledFarAwayTest, IsSucceededByOneThatHasAllOfItAndMostOfThatInItsFile) {
  start_mapper();
  drive(150);
  await_journal();
  for (int i = 0; i < 3; ++i) node_->tick(test::utime(turn_ * test::kPeriod));
  await_journal();
  EXPECT_GT(num_away(), 70);
  const Records before = records();
  const int nodes = node_->mapper().atlas().size();
  kill_mapper_at_once();
  start_mapper();
  EXPECT_EQ(records(), before);
  EXPECT_GT(num_away(), 70);
  ASSERT_EQ(node_->mapper().atlas().size(), nodes);
  for (int i = 0; i < nodes; ++i) EXPECT_TRUE(node_->mapper().atlas().node(i).points.is_spilled());
  drive(10);
  EXPECT_EQ(counter("resumed"), 1);
  EXPECT_LT(error(), 0.1);
  EXPECT_EQ(counter("faults.far_tiles"), 0);
  EXPECT_THAT(node_->report().faults, IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::journal
