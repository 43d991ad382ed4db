#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "services/viewer/store/curb_lines.hpp"

namespace curbstone::viewer::store {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;
using CurbPut = CurbLines::Put;

/// From x = first to last, a vertex each metre, at y.
curb_line_t line_at(int first, int last, float y = 0) {
  curb_line_t line{};
  for (int x = first; x <= last; ++x) {
    line.x.push_back(static_cast<float>(x));
    line.y.push_back(y);
    line.z.push_back(0);
    line.height.push_back(0.1F);
    line.high_side_x.push_back(0);
    line.high_side_y.push_back(1);
  }
  line.num_points = static_cast<std::int32_t>(line.x.size());
  return line;
}

curb_lines_t curbs_of(float x_min, float x_max, std::vector<curb_line_t> lines) {
  curb_lines_t message{};
  message.box_min[0] = x_min;
  message.box_max[0] = x_max;
  message.box_min[1] = -10;
  message.box_max[1] = 10;
  message.num_lines = static_cast<std::int32_t>(lines.size());
  message.lines = std::move(lines);
  return message;
}

std::vector<std::vector<float>> all_x(const CurbLines& curbs) {
  std::vector<std::vector<float>> all;
  for (const auto& added : curbs.above(0).added) all.push_back(added.line->x);
  return all;
}

TEST(CurbLinesTest, AMessageReplacesWhatLiesInItsBoxAndCutsWhatLeavesIt) {
  CurbLines curbs;
  ASSERT_EQ(curbs.put(curbs_of(0, 10, {line_at(0, 10)})), CurbPut::kTaken);
  ASSERT_EQ(curbs.put(curbs_of(6, 16, {line_at(7, 16, 1)})), CurbPut::kTaken);
  EXPECT_THAT(all_x(curbs), ::testing::UnorderedElementsAre(ElementsAre(0, 1, 2, 3, 4, 5, 6),
                                                            ElementsAre(7, 8, 9, 10, 11, 12, 13, 14, 15, 16)))
      << "one vertex inside stays, so that the parts touch";
  ASSERT_EQ(curbs.put(curbs_of(-5, 20, {})), CurbPut::kTaken);
  EXPECT_THAT(all_x(curbs), SizeIs(0));
}

TEST(CurbLinesTest, WhatIsSaidAgainIsNoNews) {
  CurbLines curbs;
  curbs.put(curbs_of(0, 10, {line_at(0, 10)}));
  curbs.put(curbs_of(5, 15, {line_at(6, 15, 2)}));
  const std::uint32_t number = curbs.number();
  curbs.put(curbs_of(5, 15, {line_at(6, 15, 2)}));
  EXPECT_EQ(curbs.number(), number);
}

TEST(CurbLinesTest, TellsWhoHasANumberWhatCameAndWhatWent) {
  CurbLines curbs;
  curbs.put(curbs_of(0, 10, {line_at(0, 4), line_at(6, 10)}));
  const auto first = curbs.above(0);
  EXPECT_TRUE(first.everything);
  curbs.put(curbs_of(0, 10, {line_at(0, 4), line_at(6, 9)}));
  const auto news = curbs.above(first.number);
  EXPECT_FALSE(news.everything);
  ASSERT_THAT(news.gone, ElementsAre(first.added[1].name));
  ASSERT_THAT(news.added, SizeIs(1));
  EXPECT_THAT(news.added[0].line->x, ElementsAre(6, 7, 8, 9));
  EXPECT_THAT(curbs.above(news.number).added, SizeIs(0));
}

TEST(CurbLinesTest, AnyListenerComesToTheSameLines) {
  std::srand(4);
  CurbLines curbs;
  struct Listener {
    std::uint32_t number = 0;
    std::set<std::uint32_t> names;
  };
  std::vector<Listener> listeners(5);
  for (int round = 0; round < 300; ++round) {
    const int at = std::rand() % 50;
    std::vector<curb_line_t> lines;
    for (int n = std::rand() % 4; n > 0; --n)
      lines.push_back(line_at(at + std::rand() % 5, at + 6 + std::rand() % 4, static_cast<float>(n)));
    curbs.put(curbs_of(static_cast<float>(at), static_cast<float>(at + 10), std::move(lines)));
    if (round == 200) curbs.clear();
    for (Listener& listener : listeners) {
      if (std::rand() % 5 != 0 && round < 299) continue;
      const auto news = curbs.above(listener.number);
      if (news.everything) listener.names.clear();
      for (const std::uint32_t name : news.gone) EXPECT_EQ(listener.names.erase(name), 1U);
      for (const auto& added : news.added) EXPECT_TRUE(listener.names.insert(added.name).second);
      listener.number = news.number;
    }
  }
  std::set<std::uint32_t> all;
  for (const auto& added : curbs.above(0).added) all.insert(added.name);
  EXPECT_FALSE(all.empty());
  for (const Listener& listener : listeners) EXPECT_EQ(listener.names, all);
}

TEST(CurbLinesTest, RefusesWhatCannotBeDrawn) {
  CurbLines curbs;
  curb_line_t bad = line_at(0, 3);
  bad.y[2] = NAN;
  EXPECT_EQ(curbs.put(curbs_of(0, 10, {bad})), CurbPut::kRefused);
  bad = line_at(0, 3);
  bad.height.pop_back();
  EXPECT_EQ(curbs.put(curbs_of(0, 10, {bad})), CurbPut::kRefused);
  EXPECT_EQ(curbs.put(curbs_of(0, NAN, {})), CurbPut::kRefused);
  EXPECT_EQ(curbs.put(curbs_of(10, 0, {})), CurbPut::kRefused);
  EXPECT_EQ(curbs.number(), 0U);
}

TEST(CurbLinesTest, HasAnEnd) {
  CurbLines curbs;
  std::vector<curb_line_t> lines(CurbLines::kMaxVertices / 1000 + 1, line_at(0, 999));
  for (std::size_t i = 0; i < lines.size(); ++i) lines[i].z.assign(1000, static_cast<float>(i));
  EXPECT_EQ(curbs.put(curbs_of(0, 1, std::move(lines))), CurbPut::kFull);
  EXPECT_THAT(curbs.above(0).added, SizeIs(CurbLines::kMaxVertices / 1000));
}

}  // namespace
}  // namespace curbstone::viewer::store
