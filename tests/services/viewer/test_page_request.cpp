#include <gtest/gtest.h>

#include "services/viewer/page_request.hpp"

namespace curbstone::viewer {
namespace {

bool is_nonsense(const std::string& text) {
  const PageRequest request = parse_page_request(text);
  return !request.resumes && !request.drawn && !request.play && !request.points;
}

TEST(PageRequest, SayWhatOfTheDenseCloudIsWanted) {
  const auto wide = parse_page_request(R"({"cloud": {"wide": true, "saliency": true, "cut": null}})").cloud;
  ASSERT_TRUE(wide);
  EXPECT_TRUE(wide->wide);
  EXPECT_TRUE(wide->saliency);
  EXPECT_FALSE(wide->cut);
  const auto cut = parse_page_request(R"({"cloud": {"cut": [3.5, -2]}})").cloud;
  ASSERT_TRUE(cut);
  EXPECT_FALSE(cut->wide);
  EXPECT_EQ(cut->cut, (std::pair{3.5, -2.0}));
  EXPECT_FALSE(parse_page_request(R"({"cloud": true})").cloud);
  for (const char* text :
       {R"({"cloud": {"cut": [1]}})", R"({"cloud": {"cut": ["x", 2]}})", R"({"cloud": {"wide": 1}})"})
    EXPECT_FALSE(parse_page_request(text).cloud->any()) << text;
}

TEST(PageRequest, TellWhatThePageHas) {
  const PageRequest request = parse_page_request(R"({"resume": {"run": 7, "epoch": 12, "number": 34}})");
  EXPECT_TRUE(request.resumes);
  ASSERT_TRUE(request.has);
  EXPECT_EQ(request.has->run, 7);
  EXPECT_EQ(request.has->epoch, 12);
  EXPECT_EQ(request.has->number, 34U);
}

TEST(PageRequest, APageThatHasNothingOrMarsItBeginsWithNothing) {
  for (const char* text : {R"({"resume": null})", R"({"resume": {"run": 7, "epoch": -1, "number": 0}})",
                           R"({"resume": {"run": 7, "epoch": 1e10, "number": 0}})",
                           R"({"resume": {"run": 7, "epoch": 1, "number": "2"}})"}) {
    const PageRequest request = parse_page_request(text);
    EXPECT_TRUE(request.resumes) << text;
    EXPECT_FALSE(request.has) << text;
  }
}

TEST(PageRequest, TellWhatItDrewWantsAndOrders) {
  EXPECT_EQ(parse_page_request(R"({"ack": 4294967295})").drawn, 4294967295U);
  EXPECT_EQ(parse_page_request(R"({"points": false})").points, false);
  const auto play = parse_page_request(R"({"play": {"pause": true, "position": 0}})").play;
  ASSERT_TRUE(play);
  EXPECT_EQ(play->pause, true);
  EXPECT_FALSE(play->speed);
  EXPECT_EQ(play->position, 0);
}

TEST(PageRequest, WhatCannotBeMeantIsNotSaid) {
  for (const char* text :
       {"", "{", "[]", "7", "{}", R"({"ack": -1})", R"({"ack": 4294967296})", R"({"ack": "1"})", R"({"points": 1})",
        R"({"play": 3})", R"({"play": {"speed": 0}})", R"({"play": {"position": -1}})"})
    EXPECT_TRUE(is_nonsense(text)) << text;
}

}  // namespace
}  // namespace curbstone::viewer
