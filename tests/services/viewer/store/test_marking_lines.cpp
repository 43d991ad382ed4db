#include "services/viewer/store/marking_lines.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace curbstone::viewer::store {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;
using MarkingPut = MarkingLines::Put;

/// Dashes of a metre along x, a vertex each metre from `first` to `last`.
marking_line_t dashes(int first, int last) {
  marking_line_t line{};
  line.type = marking_line_t::DASHED;
  line.width = 0.12F;
  for (int x = first; x <= last; ++x) {
    line.x.push_back(static_cast<float>(x));
    line.y.push_back(0);
    line.z.push_back(0);
    line.painted.push_back(x % 2 == 0 && x < last ? 1 : 0);
  }
  line.num_points = static_cast<std::int32_t>(line.x.size());
  return line;
}

marking_lines_t markings_of(float x_min, float x_max, std::vector<marking_line_t> lines) {
  marking_lines_t message{};
  message.box_min[0] = x_min;
  message.box_max[0] = x_max;
  message.box_min[1] = -10;
  message.box_max[1] = 10;
  message.num_lines = static_cast<std::int32_t>(lines.size());
  message.lines = std::move(lines);
  return message;
}

TEST(MarkingLinesTest, WhatIsCutKeepsItsGapsAndItsWidth) {
  MarkingLines markings;
  ASSERT_EQ(markings.put(markings_of(0, 10, {dashes(0, 10)})), MarkingPut::kTaken);
  ASSERT_EQ(markings.put(markings_of(5, 20, {})), MarkingPut::kTaken);
  const auto left = markings.above(0).added;
  ASSERT_THAT(left, SizeIs(1));
  EXPECT_THAT(left[0].line->x, ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(left[0].line->painted, ElementsAre(1, 0, 1, 0, 1, 0));
  EXPECT_EQ(left[0].line->num_points, 6);
  EXPECT_FLOAT_EQ(left[0].line->width, 0.12F);
}

TEST(MarkingLinesTest, RefusesWhatCannotBeDrawn) {
  MarkingLines markings;
  marking_line_t short_list = dashes(0, 4);
  short_list.painted.pop_back();
  marking_line_t nowhere = dashes(0, 4);
  nowhere.x[2] = NAN;
  marking_line_t endless = dashes(0, 4);
  endless.width = INFINITY;
  for (const auto& bad : {short_list, nowhere, endless})
    EXPECT_EQ(markings.put(markings_of(0, 10, {bad})), MarkingPut::kRefused);
  EXPECT_THAT(markings.above(0).added, SizeIs(0));
}

TEST(MarkingLinesTest, APieceThatIsPaintedNowIsNews) {
  MarkingLines markings;
  markings.put(markings_of(0, 10, {dashes(0, 10)}));
  const auto number = markings.number();
  markings.put(markings_of(0, 10, {dashes(0, 10)}));
  EXPECT_EQ(markings.number(), number) << "the same said again";
  marking_line_t more = dashes(0, 10);
  more.painted[1] = 1;
  markings.put(markings_of(0, 10, {more}));
  EXPECT_THAT(markings.above(number).added, SizeIs(1));
}

}  // namespace
}  // namespace curbstone::viewer::store
