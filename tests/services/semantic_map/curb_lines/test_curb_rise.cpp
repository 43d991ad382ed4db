#include "services/semantic_map/curb_lines/curb_rise.hpp"

#include <gtest/gtest.h>

namespace curbstone::semantic_map::curb_lines {
namespace {

/// Along x, the higher side at y < 0.
tile::CurbLine along_x() {
  tile::CurbLine line;
  for (int i = 0; i < 50; ++i)
    line.points.push_back({.x = 0.12F * static_cast<float>(i), .high_side_x = 0, .high_side_y = -1});
  return line;
}

TEST(CurbRise, IsUpFromTheLowerSideAndDownFromTheHigherOne) {
  EXPECT_EQ(seen_from(along_x(), {{0, 3}, {6, 3}}), CurbRise::kUp);
  EXPECT_EQ(seen_from(along_x(), {{0, -3}, {6, -3}}), CurbRise::kDown);
}

TEST(CurbRise, GoesByWhereThePathIsNearest) {
  EXPECT_EQ(seen_from(along_x(), {{0, 3}, {2, 3}, {4, 3}, {6, 3}, {6, -9}, {0, -9}}), CurbRise::kUp);
}

TEST(CurbRise, IsUnknownWithoutAPathOrALine) {
  EXPECT_EQ(seen_from(along_x(), {}), CurbRise::kUnknown);
  EXPECT_EQ(seen_from({}, {{0, 3}}), CurbRise::kUnknown);
}

}  // namespace
}  // namespace curbstone::semantic_map::curb_lines
