#include "services/viewer/foxglove/scene_messages.hpp"

#include <foxglove/scene.pb.h>
#include <gmock/gmock.h>

#include <cmath>

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

/// Empty: there is no such pair.
std::string value_of(const ::foxglove::SceneEntity& entity, const std::string& key) {
  for (const auto& pair : entity.metadata())
    if (pair.key() == key) return pair.value();
  return "";
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
  const auto changes = scene_of(curbs_message(curbs.above(first.number), 8));
  ASSERT_EQ(changes.deletions_size(), 1);
  EXPECT_EQ(changes.deletions(0).type(), ::foxglove::SceneEntityDeletion::MATCHING_ID);
  EXPECT_EQ(changes.deletions(0).id(), "curb 2");
  EXPECT_EQ(changes.entities_size(), 1);
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

TEST(CurbsMessageTest, DrawsWhatNobodySawThinnerAndHalfTransparent) {
  store::CurbLines curbs;
  curb_lines_t seen = curb_at(0, false);
  curb_lines_t inferred = curb_at(10, false);
  inferred.lines[0].inferred = 1;
  curbs.put(seen);
  curbs.put(inferred);
  const auto scene = scene_of(curbs_message(curbs.above(0), 7));
  ASSERT_EQ(scene.entities_size(), 2);
  EXPECT_EQ(value_of(scene.entities(0), "inferred"), "no");
  EXPECT_EQ(value_of(scene.entities(1), "inferred"), "yes");
  const auto& edge = scene.entities(0).lines(1);
  const auto& bridge = scene.entities(1).lines(1);
  EXPECT_LT(bridge.color().a(), edge.color().a());
  EXPECT_LT(bridge.thickness(), edge.thickness());
}

/// Along x at `y`, a vertex a metre; painted from those points to the next one of which `painted` says so.
marking_lines_t marking_at(float y, std::int8_t type, std::vector<std::int8_t> painted) {
  marking_line_t line{};
  line.type = type;
  line.confidence = 0.75F;
  line.width = 0.2F;
  line.num_points = static_cast<std::int32_t>(painted.size());
  for (std::size_t i = 0; i < painted.size(); ++i) {
    line.x.push_back(static_cast<float>(i));
    line.y.push_back(y);
    line.z.push_back(0.5F);
  }
  line.painted = std::move(painted);
  marking_lines_t message{};
  message.box_min[0] = -1;
  message.box_min[1] = y - 1;
  message.box_max[0] = 20;
  message.box_max[1] = y + 1;
  message.num_lines = 1;
  message.lines = {line};
  return message;
}

/// m^2, from above; each triangle counts with its sign.
double area_of(const ::foxglove::TriangleListPrimitive& paint) {
  double area = 0;
  for (int i = 0; i + 2 < paint.indices_size(); i += 3) {
    const auto& a = paint.points(static_cast<int>(paint.indices(i)));
    const auto& b = paint.points(static_cast<int>(paint.indices(i + 1)));
    const auto& c = paint.points(static_cast<int>(paint.indices(i + 2)));
    area += ((b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x())) / 2;
  }
  return area;
}

TEST(MarkingsMessageTest, PaintsThePiecesThatArePaintedAsWideAsTheyAre) {
  store::MarkingLines markings;
  markings.put(marking_at(3, marking_line_t::DASHED, {1, 1, 0, 0, 1, 0}));
  const auto scene = scene_of(markings_message(markings.above(0), 7));
  ASSERT_EQ(scene.entities_size(), 1);
  const auto& entity = scene.entities(0);
  EXPECT_EQ(entity.frame_id(), "map");
  EXPECT_EQ(value_of(entity, "type"), "dashed line");
  EXPECT_EQ(value_of(entity, "width"), "0.20 m");
  EXPECT_EQ(value_of(entity, "gap"), "") << "not known";
  ASSERT_EQ(entity.triangles_size(), 1);
  const auto& paint = entity.triangles(0);
  EXPECT_NEAR(std::abs(area_of(paint)), 3 * 0.2, 1e-6) << "three of five metres are painted";
  for (const auto& point : paint.points()) {
    EXPECT_NEAR(std::abs(point.y() - 3), 0.1, 1e-6);
    EXPECT_GT(point.z(), 0.5);
    EXPECT_LT(point.z(), 0.55);
    EXPECT_FALSE(point.x() > 2.01 && point.x() < 3.99) << "a gap";
  }
}

TEST(MarkingsMessageTest, ACornerIsClosedAndALineThatTurnsBackStaysFinite) {
  store::MarkingLines markings;
  marking_lines_t corner = marking_at(0, marking_line_t::SOLID, {1, 1, 0});
  corner.lines[0].x = {0, 1, 1};
  corner.lines[0].y = {0, 0, 1};
  markings.put(corner);
  marking_lines_t back = marking_at(10, marking_line_t::OTHER, {1, 1, 1, 0});
  back.lines[0].x = {0, 1, 0, 0};
  back.lines[0].width = 0;
  markings.put(back);
  const auto scene = scene_of(markings_message(markings.above(0), 7));
  ASSERT_EQ(scene.entities_size(), 2);
  const auto& paint = scene.entities(0).triangles(0);
  ASSERT_EQ(paint.points_size(), 6);
  EXPECT_NEAR(paint.points(3).x(), 1.1, 1e-6) << "outside of the corner";
  EXPECT_NEAR(paint.points(3).y(), -0.1, 1e-6);
  EXPECT_NEAR(paint.points(2).x(), 0.9, 1e-6);
  EXPECT_NEAR(paint.points(2).y(), 0.1, 1e-6);
  EXPECT_EQ(value_of(scene.entities(1), "width"), "unknown");
  for (const auto& point : scene.entities(1).triangles(0).points()) {
    EXPECT_LT(std::abs(point.x()), 1.2);
    EXPECT_LT(std::abs(point.y() - 10), 0.2);
  }
}

TEST(MarkingsMessageTest, TellsFirstOfEverythingAndThenOfWhatChanged) {
  store::MarkingLines markings;
  markings.put(marking_at(0, marking_line_t::SOLID, {1, 0}));
  markings.put(marking_at(10, 77, {1, 0}));
  const auto first = markings.above(0);
  const auto all = scene_of(markings_message(first, 7));
  ASSERT_EQ(all.deletions_size(), 1);
  EXPECT_EQ(all.deletions(0).type(), ::foxglove::SceneEntityDeletion::ALL);
  EXPECT_THAT(ids(all), ElementsAre("marking 1", "marking 2"));
  EXPECT_EQ(value_of(all.entities(1), "type"), "unknown") << "of a later version";

  markings.put(marking_at(10, marking_line_t::CROSSING, {1, 0}));
  const auto changes = scene_of(markings_message(markings.above(first.number), 8));
  ASSERT_EQ(changes.deletions_size(), 1);
  EXPECT_EQ(changes.deletions(0).id(), "marking 2");
  ASSERT_EQ(changes.entities_size(), 1);
  EXPECT_EQ(value_of(changes.entities(0), "type"), "crossing");
}

TEST(PathMessageTest, SendsThePiecesThatChanged) {
  store::ThinnedPath path;
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
