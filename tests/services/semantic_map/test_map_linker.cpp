#include "services/semantic_map/map_linker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "tests/services/semantic_map/synthetic_ground.hpp"

namespace curbstone::semantic_map {
namespace {

int with_paint(double y) {
  return std::abs(y + 1) < 0.06 ? 200 : 64;
}

/// A street with a kerb at y = 1 and paint along y = -1. `intensity`: of the ground, by y in m.
std::vector<tile::VotedTile> street(int (*intensity)(double y) = with_paint) {
  SyntheticCloud cloud;
  cloud.ground(-6, -6, 6, 6, 150, [](double x, double y) { return 0.02 * x + (y > 1 ? 0.1 : 0.0); });
  detect::cloud_map::CloudMap counts;
  detect::cloud_map::CloudMapOptions options;
  options.threads = 1;
  auto tiles = detect::cloud_map::vote_tiles(cloud.points, options, counts);
  for (tile::VotedTile& tile : tiles) {
    tile.intensity.clear();
    for (const tile::VotedPoint& p : tile.points) {
      const double y = tile.key.y * kTileSize + double{p.y};
      tile.intensity.push_back(static_cast<std::uint8_t>(intensity(y)));
    }
  }
  return tiles;
}

tile::VotedTile empty(TileKey key) {
  tile::VotedTile tile;
  tile.key = key;
  return tile;
}

struct LinkedStreet : testing::Test {
  void drive(double x) {
    const auto utime = static_cast<std::int64_t>(1e6 * (x + 100));
    path.add(utime, {x, -2.0});
    linker.add_place(utime, {x, -2.0});
  }
  /// Links later, when the map is another already.
  [[nodiscard]] store::MapKeeper::LinkLines ask() { return linker.link_snapshot(pipeline, nullptr); }
  [[nodiscard]] tile::MapLines at_once() const { return link(line_sources(pipeline, path, {})); }

  std::vector<tile::VotedTile> tiles = street();
  pipeline::TilePipeline pipeline{{}, {}};
  tile::DrivenPath path;
  MapLinker linker{{}};
};

void expect_same(const tile::MapLines& a, const tile::MapLines& b) {
  EXPECT_EQ(a.curbs, b.curbs);
  EXPECT_EQ(a.markings, b.markings);
}

TEST_F(LinkedStreet, IsWhatItWasWhenItsLinesWereAskedFor) {
  double x = -6;
  for (const tile::VotedTile& tile : tiles) {
    pipeline.set_voted(tile);
    pipeline.settle();
    drive(x += 0.5);
    const auto lines = ask();
    const tile::MapLines then = at_once();
    pipeline.set_voted(empty(tile.key));
    pipeline.settle();
    expect_same(lines(), then);
    pipeline.set_voted(tile);
  }
  pipeline.settle();
  const tile::MapLines whole = ask()();
  expect_same(whole, at_once());
  EXPECT_FALSE(whole.curbs.empty());
  EXPECT_FALSE(whole.markings.empty());
  EXPECT_EQ(whole.markings, all_markings(pipeline, whole.curbs, path, {})) << "cells far from paint change nothing";
}

/// Mended asphalt, broad and pale, is told from paint by the tar along its edge, here in tiles without anything bright.
TEST_F(LinkedStreet, HasItsPaintMeasuredAcrossTheEdgesOfTiles) {
  const auto mended = [](double y) { return y > -0.5 && y < 0 ? 95 : y >= 0 && y < 0.25 ? 10 : 64; };
  for (const tile::VotedTile& tile : street(mended)) pipeline.set_voted(tile);
  pipeline.settle();
  drive(0);
  drive(1);
  const tile::MapLines lines = at_once();
  EXPECT_TRUE(lines.markings.empty());
  EXPECT_EQ(lines.markings, all_markings(pipeline, lines.curbs, path, {}));
}

TEST_F(LinkedStreet, IsLinkedWithoutThePipelineThatMadeIt) {
  store::MapKeeper::LinkLines lines;
  tile::MapLines then;
  {
    pipeline::TilePipeline passing({}, {});
    for (const tile::VotedTile& tile : tiles) passing.set_voted(tile);
    passing.settle();
    drive(0);
    drive(1);
    lines = linker.link_snapshot(passing, nullptr);
    then = link(line_sources(passing, path, {}));
  }
  expect_same(lines(), then);
}

TEST_F(LinkedStreet, IsForgottenWithItsEpoch) {
  for (const tile::VotedTile& tile : tiles) pipeline.set_voted(tile);
  pipeline.settle();
  drive(0);
  drive(1);
  const auto before = ask();
  pipeline.clear();
  path.clear();
  linker.clear();
  pipeline.set_voted(tiles.front());
  pipeline.settle();
  drive(2);
  drive(3);
  const auto after = ask();
  EXPECT_FALSE(before().curbs.empty());
  expect_same(after(), at_once());
}

TEST_F(LinkedStreet, OfATileThatTheFileHadOnlyWhatIsNotKnownAnewIsKept) {
  tile::CurbLine line;
  for (const float x : {-100.0F, -99.0F}) line.points.push_back({.x = x, .y = 0});
  tile::CurbLine seen_again;
  for (const float x : {1.0F, 2.0F}) seen_again.points.push_back({.x = x, .y = -4});
  const auto before = std::make_shared<store::StoredLines>();
  before->lines.curbs = {line, seen_again};
  for (const tile::CurbLine& l : before->lines.curbs) {
    for (const tile::CurbVertex& v : l.points) before->tiles.insert(*tile_at(double{v.x}, double{v.y}));
  }
  pipeline.set_voted(empty({0, -2}));  // nothing is computed of it yet
  const tile::MapLines lines = linker.link_snapshot(pipeline, before)();
  ASSERT_EQ(lines.curbs.size(), 1U);
  EXPECT_EQ(lines.curbs.front().points, line.points);
}

TEST_F(LinkedStreet, TellsTheLinkerOnlyOfTilesThatBecameOthers) {
  for (const tile::VotedTile& tile : tiles) pipeline.set_voted(tile);
  pipeline.settle();
  EXPECT_EQ(pipeline.take_changed().size(), tiles.size());
  EXPECT_TRUE(pipeline.take_changed().empty());
  pipeline.set_voted(tiles.front());
  pipeline.settle();
  EXPECT_TRUE(pipeline.take_changed().empty()) << "what came was what there was";
  pipeline.set_voted(empty(tiles.front().key));
  pipeline.settle();
  const auto changed = pipeline.take_changed();
  EXPECT_GE(changed.size(), 1U);
  EXPECT_LE(changed.size(), 9U);
}

}  // namespace
}  // namespace curbstone::semantic_map
