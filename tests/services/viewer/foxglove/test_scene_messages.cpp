#include "services/viewer/foxglove/scene_messages.hpp"

#include <foxglove/scene.pb.h>
#include <gmock/gmock.h>

namespace curbstone::viewer::foxglove {
namespace {

using ::testing::ElementsAre;

::foxglove::SceneUpdate scene_of(const std::string& bytes) {
  ::foxglove::SceneUpdate scene;
  EXPECT_TRUE(scene.ParseFromString(bytes));
  return scene;
}

/// Along x at `y`, in a box of its own.
curb_lines_t curb_at(float y, bool dropped) {
  curb_line_t line{};
  line.dropped = dropped ? 1 : 0;
  line.rise = 1;
  line.confidence = 0.5F;
  line.num_points = 2;
  line.x = {0, 1};
  line.y = {y, y};
  line.z = {0.5F, 0.5F};
  line.height = {0.1F, 0.12F};
  line.high_side_x = {0, 0};
  line.high_side_y = {1, 1};
  curb_lines_t message{};
  message.box_min[0] = -1;
  message.box_min[1] = y - 1;
  message.box_max[0] = 2;
  message.box_max[1] = y + 1;
  message.num_lines = 1;
  message.lines = {line};
  return message;
}

std::vector<std::string> ids(const ::foxglove::SceneUpdate& scene) {
  std::vector<std::string> names;
  for (const auto& entity : scene.entities()) names.push_back(entity.id());
  return names;
}

TEST(CurbsMessageTest, TellsFirstOfEverythingAndThenOfWhatChanged) {
  store::CurbLines curbs;
  curbs.put(curb_at(0, false));
  curbs.put(curb_at(10, true));
  const auto first = curbs.above(0);
  const auto all = scene_of(curbs_message(first, 7));
  ASSERT_EQ(all.deletions_size(), 1);
  EXPECT_EQ(all.deletions(0).type(), ::foxglove::SceneEntityDeletion::ALL);
  EXPECT_THAT(ids(all), ElementsAre("curb 1", "curb 2"));

  curb_lines_t moved = curb_at(10, true);
  moved.lines[0].x[1] = 0.9F;
  curbs.put(moved);
  const auto news = scene_of(curbs_message(curbs.above(first.number), 8));
  ASSERT_EQ(news.deletions_size(), 1);
  EXPECT_EQ(news.deletions(0).type(), ::foxglove::SceneEntityDeletion::MATCHING_ID);
  EXPECT_EQ(news.deletions(0).id(), "curb 2");
  EXPECT_EQ(news.entities_size(), 1);
}

TEST(CurbsMessageTest, DrawsFootAndEdgeAndTellsLoweredOnesApart) {
  store::CurbLines curbs;
  curbs.put(curb_at(0, false));
  curbs.put(curb_at(10, true));
  const auto scene = scene_of(curbs_message(curbs.above(0), 7));
  const auto& high = scene.entities(0);
  ASSERT_EQ(high.lines_size(), 2);
  EXPECT_EQ(high.frame_id(), "map");
  EXPECT_EQ(high.lines(0).type(), ::foxglove::LinePrimitive::LINE_STRIP);
  EXPECT_NEAR(high.lines(0).points(1).z(), 0.5, 1e-6);
  EXPECT_NEAR(high.lines(1).points(1).z(), 0.62, 1e-6);
  EXPECT_GT(high.lines(1).color().g(), high.lines(1).color().r());
  EXPECT_LT(scene.entities(1).lines(1).color().g(), scene.entities(1).lines(1).color().r());
  EXPECT_EQ(high.metadata(0).value(), "0.120 m");
  EXPECT_EQ(high.metadata(1).value(), "up");
}

TEST(PathMessageTest, SendsThePiecesThatChanged) {
  store::DrivenPath path;
  const auto drive = [&](std::size_t points) {
    while (path.points().size() < points) {
      const auto k = static_cast<std::int64_t>(path.points().size());
      path.put({1000 * (k + 1), static_cast<float>(k) * 0.5F, 0, 0});
    }
  };
  drive(kPathPiece);
  EXPECT_THAT(ids(scene_of(path_message(path, 0, true, 1))), ElementsAre("path 0"));
  drive(kPathPiece + 1);
  const auto scene = scene_of(path_message(path, kPathPiece, false, 1));
  EXPECT_THAT(ids(scene), ElementsAre("path 0", "path 1"));
  EXPECT_EQ(scene.deletions_size(), 0);
  EXPECT_EQ(scene.entities(0).lines(0).points_size(), static_cast<int>(kPathPiece) + 1) << "it touches the next one";
  drive(kPathPiece + 50);
  EXPECT_THAT(ids(scene_of(path_message(path, kPathPiece + 10, false, 1))), ElementsAre("path 1"));
}

}  // namespace
}  // namespace curbstone::viewer::foxglove
