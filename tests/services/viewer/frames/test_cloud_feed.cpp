#include "services/viewer/frames/cloud_feed.hpp"

#include <gtest/gtest.h>

#include "services/viewer/frames/sections.hpp"
#include "tests/services/viewer/cloud_messages.hpp"
#include "tests/services/viewer/frame_reader.hpp"

namespace curbstone::viewer::frames {
namespace {

class CloudFeedTest : public ::testing::Test {
 protected:
  CloudFeedTest() { cloud_.look(3, {{0, 0, store::DenseCloud::kReach}}); }
  /// Sends one frame; returns its bytes.
  std::size_t send(double seconds = 0.1) {
    now_ += static_cast<std::int64_t>(seconds * 1e6);
    ByteWriter out;
    out.u32(1);
    write_cloud(out, feed_, cloud_, now_);
    const std::size_t bytes = out.size() - 4;
    page_.read(out.written());
    return bytes;
  }
  void expect_same() {
    ASSERT_EQ(page_.cloud.size(), cloud_.tiles().size());
    for (const auto& [key, tile] : cloud_.tiles()) {
      ASSERT_EQ(page_.cloud[key].size(), tile.slots.size());
      for (std::size_t i = 0; i < tile.slots.size(); ++i) EXPECT_EQ(page_.cloud[key][i], tile.slots[i].point);
    }
  }

  store::DenseCloud cloud_;
  CloudFeed feed_;
  FrameReader page_;
  std::int64_t now_ = 1'000'000;
};

TEST_F(CloudFeedTest, APageThatDoesNotAskGetsNothing) {
  cloud_.put(records({0, 0}, 0, 10));
  EXPECT_EQ(send(), 0U);
  feed_.want({.wide = true});
  EXPECT_GT(send(), 90U);
  expect_same();
  EXPECT_EQ(send(), 0U) << "nothing changed";
  feed_.want({});
  cloud_.put(records({0, 0}, 10, 10));
  EXPECT_EQ(send(), 0U);
}

TEST_F(CloudFeedTest, OnlyWhatChangedIsSent) {
  feed_.want({.wide = true});
  cloud_.put(voted({0, 0}, 0, 1000, 0, 1));
  send();
  cloud_.put(voted({0, 0}, 1000, 3, 1, 2));
  EXPECT_LT(send(), 100U);
  expect_same();
  voted_points_t step = voted({0, 0}, 1003, 0, 2, 3);
  step.num_tensors = 1;
  step.scale = {1};
  step.point = {500};
  for (auto* list : {&step.normal_x, &step.normal_y, &step.normal_z}) *list = {0};
  for (auto* list : {&step.tangent_x, &step.tangent_y, &step.tangent_z}) *list = {0};
  step.stick = {7};
  step.plate = {200};
  step.mass = {1};
  ASSERT_EQ(cloud_.put(step), store::DenseCloud::Put::kTaken);
  EXPECT_LT(send(), 50U);
  expect_same();
  EXPECT_EQ((page_.cloud[{0, 0}][500].line), 200);
  cloud_.put(voted({0, 0}, 0, 5, 0, 4));
  send();
  expect_same();
  EXPECT_EQ((page_.cloud[{0, 0}].size()), 5U);
}

TEST_F(CloudFeedTest, KeepsToItsRateAndBringsTheNearestFirst) {
  feed_.want({.wide = true});
  for (int x = -8; x < 8; ++x) cloud_.put(records({x, 0}, 0, 1400));
  const std::size_t first = send();
  EXPECT_LT(first, CloudFeed::kMaxBytes + 1400 * CloudFeed::kPointBytes + 100);
  EXPECT_TRUE(page_.cloud.contains({0, 0}));
  EXPECT_TRUE(page_.cloud.contains({-1, 0}));
  EXPECT_FALSE(page_.cloud.contains({7, 0}));
  std::size_t bytes = first;
  int frames = 0;
  for (; page_.cloud.size() < 16 && frames < 100; ++frames) bytes += send(0.02);
  EXPECT_LT(static_cast<double>(bytes), CloudFeed::kMaxBytes + CloudFeed::kRate * 0.02 * frames + 13'000);
  EXPECT_LT(frames, 60);
  expect_same();
}

TEST_F(CloudFeedTest, ACrossSectionBringsItsTilesAndThoseFirst) {
  for (int x = -8; x < 8; ++x) cloud_.put(records({x, 0}, 0, 1400));
  feed_.want({.cut = std::pair{18.5, 1.5}});
  while (send() > 5) continue;
  EXPECT_EQ(page_.cloud.size(), 3U);
  EXPECT_TRUE(page_.cloud.contains({6, 0}));
  feed_.want({.wide = true, .cut = std::pair{-22.0, 1.5}});
  page_.cloud.clear();
  send();
  EXPECT_TRUE(page_.cloud.contains({-8, 0}));
}

TEST_F(CloudFeedTest, ATileThatComesAgainIsSentWhole) {
  feed_.want({.wide = true});
  cloud_.put(records({0, 0}, 0, 50));
  send();
  cloud_.look(3, {{100, 0, store::DenseCloud::kReach}});
  cloud_.look(3, {{0, 0, store::DenseCloud::kReach}});
  cloud_.put(records({0, 0}, 30, 20));
  send();
  expect_same();
}

}  // namespace
}  // namespace curbstone::viewer::frames
