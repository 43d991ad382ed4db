#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "common/bus/local_bus.hpp"
#include "tests/services/semantic_map/semantic_map_node_test.hpp"

namespace curbstone::semantic_map {
namespace {

TEST_F(SemanticMapNodeTest, RefusesBadPagesByCauseAndLives) {
  LocalBus bus;
  SemanticMapNode node(config(""), bus);
  node.connect(bus);
  const auto good = to_pages(full_tile(), 2, 200).front();
  const auto send = [&](auto change) {
    voted_points_t bad = good;
    change(bad);
    bus.publish("VOTED_POINTS", bad);
    bus.dispatch();
  };
  send([](voted_points_t& m) { m.revision = 0; });
  send([](voted_points_t& m) { m.total = -1; });
  send([](voted_points_t& m) { m.total = 2'000'000'000; });
  send([](voted_points_t& m) { m.first = m.total; });
  send([](voted_points_t& m) { m.first = -5; });
  send([](voted_points_t& m) { m.z_origin = std::nanf(""); });
  send([](voted_points_t& m) { m.x[3] = 1500; });
  send([](voted_points_t& m) { m.y[3] = -1; });
  send([](voted_points_t& m) { m.mass[7] = std::nanf(""); });
  send([](voted_points_t& m) { m.num_scales = 0; });
  send([](voted_points_t& m) { m.base = m.revision + 1; });
  send([](voted_points_t& m) { m.voter[5] = 6; });
  send([](voted_points_t& m) { m.point[5] = m.total; });
  send([](voted_points_t& m) { m.scale[5] = 1; });
  send([](voted_points_t& m) { m.page = m.num_pages; });
  send([](voted_points_t& m) { m.page = 0, m.num_pages = 1; });
  send([](voted_points_t& m) {
    m.num_scales = 2;
    m.sigma = {0.3F, 0.1F};
  });
  const Counters counters = node.report().counters;
  EXPECT_EQ(counters["refused.revision"], 2);
  EXPECT_EQ(counters["refused.size"], 8);
  EXPECT_EQ(counters["refused.voter"], 3);
  EXPECT_EQ(counters["refused.height"], 1);
  EXPECT_EQ(counters["refused.position"], 2);
  EXPECT_EQ(counters["refused.mass"], 1);

  map_pose_t pose = pose_at(kStart, 0);
  pose.map_base_position[1] = std::nan("");
  bus.publish("MAP_POSE", pose);
  bus.dispatch();
  EXPECT_EQ(node.report().counters["refused.pose"], 1);
  node.tick(kStart);
  node.finish();
}

TEST_F(SemanticMapNodeTest, RandomValuesInMessagesDoNoHarm) {
  LocalBus bus;
  SemanticMapNode node(config(""), bus);
  node.connect(bus);
  const auto good = to_pages(full_tile(), 2, 100).front();
  std::mt19937 random(3);
  const auto any = [&] { return static_cast<std::int32_t>(random() >> random() % 32); };
  for (int i = 0; i < 3000; ++i) {
    voted_points_t m = good;
    std::int32_t* fields[] = {&m.tile_x,
                              &m.tile_y,
                              &m.revision,
                              &m.total,
                              &m.first,
                              &m.base,
                              &m.page,
                              &m.num_pages,
                              &m.voter.front(),
                              &m.voter[9],
                              &m.point[random() % 50]};
    *fields[random() % std::size(fields)] = any();
    if (i % 50 == 25) m.epoch = i / 50;
    const std::size_t k = random() % m.x.size();
    m.x[k] = static_cast<std::int16_t>(any());
    m.z[k] = static_cast<std::int16_t>(any());
    m.normal_x[k] = m.normal_y[k] = m.normal_z[k] = static_cast<std::int16_t>(any());
    if (i % 7 == 0) m.z_origin = std::bit_cast<float>(any());
    if (i % 11 == 0) m.sigma[0] = std::bit_cast<float>(any());
    if (i % 2 == 0) {  // half of them complete a tile
      m.total = m.num_points;
      m.num_pages = 1;
    }
    bus.publish("VOTED_POINTS", m);
    bus.dispatch();
    if (i % 100 == 0) node.tick(kStart + i * 20'000);
  }
  node.finish();
  EXPECT_GT(node.report().counters["voted_tiles"], 10);
  EXPECT_GT(node.report().counters["refused.size"], 5);
}

TEST_F(SemanticMapNodeTest, RefusesToStartOnAFileThatIsNoMap) {
  std::ofstream(folder_ / "map.db") << "not a map, and long enough to be read as a header of one, is it not?";
  LocalBus bus;
  EXPECT_THROW(SemanticMapNode(config("map.db"), bus), store::MapStoreError);
}

}  // namespace
}  // namespace curbstone::semantic_map
