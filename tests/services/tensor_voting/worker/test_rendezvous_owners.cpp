#include "services/tensor_voting/worker/rendezvous_owners.hpp"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "tests/stamps.hpp"

namespace curbstone::tensor_voting::worker {
namespace {

using test::kSecond;

std::set<TileKey> owned(const RendezvousOwners& workers, int half = 40) {
  std::set<TileKey> tiles;
  for (int x = -half; x < half; ++x) {
    for (int y = -half; y < half; ++y) {
      if (workers.owns({x, y})) tiles.insert({x, y});
    }
  }
  return tiles;
}

TEST(RendezvousOwners, EveryTileHasExactlyOneOwnerAndAllDoTheirShare) {
  const std::vector<std::string> names{"tensor_voting:1", "tensor_voting:2", "tensor_voting:3"};
  std::size_t total = 0;
  std::set<TileKey> all;
  for (const auto& self : names) {
    RendezvousOwners workers(self, 2 * kSecond);
    for (const auto& name : names) workers.on_heartbeat(name, 0);
    EXPECT_TRUE(workers.update(0));
    const auto tiles = owned(workers);
    EXPECT_GT(tiles.size(), 1600U) << "of 6400";
    total += tiles.size();
    all.insert(tiles.begin(), tiles.end());
  }
  EXPECT_EQ(total, 6400U);
  EXPECT_EQ(all.size(), 6400U);
}

TEST(RendezvousOwners, OnlyTheTilesOfWhoComesOrGoesMove) {
  RendezvousOwners workers("b", 2 * kSecond);
  EXPECT_EQ(owned(workers).size(), 6400U) << "alone";
  EXPECT_FALSE(workers.update(0));
  workers.on_heartbeat("a", 0);
  EXPECT_EQ(owned(workers).size(), 6400U) << "owners change with update(), not between";
  EXPECT_TRUE(workers.update(0));
  EXPECT_FALSE(workers.update(kSecond));
  const auto with_a = owned(workers);
  workers.on_heartbeat("c", kSecond);
  EXPECT_TRUE(workers.update(kSecond));
  for (const TileKey& key : owned(workers)) EXPECT_TRUE(with_a.contains(key)) << "nothing moves between a and b";
  workers.on_heartbeat("a", 3 * kSecond);
  EXPECT_TRUE(workers.update(4 * kSecond)) << "c has been silent for too long";
  EXPECT_EQ(owned(workers), with_a);
}

TEST(RendezvousOwners, WhoWasHeardInTheFutureIsGoneOrHeardAgain) {
  RendezvousOwners workers("b", 2 * kSecond);
  workers.on_heartbeat("a", 3600 * kSecond);
  workers.on_heartbeat("c", 3600 * kSecond);
  EXPECT_TRUE(workers.update(3600 * kSecond));
  workers.on_heartbeat("a", 0);  // the host's clock was set back
  EXPECT_TRUE(workers.update(kSecond));
  EXPECT_EQ(workers.count(), 2U) << "c is dead";
}

TEST(RendezvousOwners, OneselfIsAlwaysAliveAndStrangersAreBounded) {
  RendezvousOwners workers("a", kSecond);
  workers.on_heartbeat("a", 0);
  EXPECT_FALSE(workers.update(0));
  for (int i = 0; i < 1000; ++i) workers.on_heartbeat("stranger " + std::to_string(i), 0);
  EXPECT_TRUE(workers.update(0));
  EXPECT_EQ(workers.count(), RendezvousOwners::kMaxWorkers + 1);
}

}  // namespace
}  // namespace curbstone::tensor_voting::worker
