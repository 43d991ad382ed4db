#include <gtest/gtest.h>

#include "services/viewer/page_words.hpp"

namespace curbstone::viewer {
namespace {

bool is_nonsense(const std::string& text) {
  const PageWords words = read_page_words(text);
  return !words.resumes && !words.drawn && !words.play && !words.points;
}

TEST(PageWords, TellWhatThePageHas) {
  const PageWords words = read_page_words(R"({"resume": {"run": 7, "epoch": 12, "number": 34}})");
  EXPECT_TRUE(words.resumes);
  ASSERT_TRUE(words.has);
  EXPECT_EQ(words.has->run, 7);
  EXPECT_EQ(words.has->epoch, 12);
  EXPECT_EQ(words.has->number, 34U);
}

TEST(PageWords, APageThatHasNothingOrMarsItBeginsWithNothing) {
  for (const char* text : {R"({"resume": null})", R"({"resume": {"run": 7, "epoch": -1, "number": 0}})",
                           R"({"resume": {"run": 7, "epoch": 1e10, "number": 0}})",
                           R"({"resume": {"run": 7, "epoch": 1, "number": "2"}})"}) {
    const PageWords words = read_page_words(text);
    EXPECT_TRUE(words.resumes) << text;
    EXPECT_FALSE(words.has) << text;
  }
}

TEST(PageWords, TellWhatItDrewWantsAndOrders) {
  EXPECT_EQ(read_page_words(R"({"ack": 4294967295})").drawn, 4294967295U);
  EXPECT_EQ(read_page_words(R"({"points": false})").points, false);
  const auto play = read_page_words(R"({"play": {"pause": true, "position": 0}})").play;
  ASSERT_TRUE(play);
  EXPECT_EQ(play->pause, true);
  EXPECT_FALSE(play->speed);
  EXPECT_EQ(play->position, 0);
}

TEST(PageWords, WhatCannotBeMeantIsNotSaid) {
  for (const char* text :
       {"", "{", "[]", "7", "{}", R"({"ack": -1})", R"({"ack": 4294967296})", R"({"ack": "1"})", R"({"points": 1})",
        R"({"play": 3})", R"({"play": {"speed": 0}})", R"({"play": {"position": -1}})"})
    EXPECT_TRUE(is_nonsense(text)) << text;
}

}  // namespace
}  // namespace curbstone::viewer
