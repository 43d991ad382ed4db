#include <fstream>
#include <iterator>
#include <limits>

#include "tests/services/localizer/localizer_on_a_yard.hpp"

namespace curbstone::localizer {
namespace {

using semantic_map::store::MapStore;
using semantic_map::store::MapStoreError;
using test_yard::kRevolution;
using test_yard::kStart;
using test_yard::LocalizerOnAYard;
using ::testing::Contains;
using ::testing::HasSubstr;

std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(LocalizerOnAYard, CountsGarbageAndKeepsItsPlace) {
  begin();
  odometry_until(20);
  lidar_until(20);
  odometry_t bad = odometry(heard_);
  bad.position[1] = std::numeric_limits<double>::quiet_NaN();
  node_->on(bad);
  lidar_points_t short_packet = packet(20);
  short_packet.y.resize(3);
  node_->on(short_packet);
  lidar_points_t blind = packet(20);
  std::fill(blind.x.begin(), blind.x.end(), std::numeric_limits<float>::quiet_NaN());
  node_->on(blind);
  ++seen_;
  odometry_until(30);
  lidar_until(31);
  EXPECT_EQ(node_->report().counters["refused.odometry"], 1);
  EXPECT_EQ(node_->report().counters["refused.packet"], 1);
  EXPECT_FALSE(poses_.back().flags & map_pose_t::LOST);
}

TEST_F(LocalizerOnAYard, ALongSilenceMakesItLostUntilTheMapHasFittedForAWhile) {
  begin();
  odometry_until(20);
  lidar_until(20);
  seen_ = 420;  // 20 s
  heard_ = kStart + 420 * kRevolution - 50'000;
  odometry_until(500);
  lidar_until(425);
  EXPECT_TRUE(poses_.back().flags & map_pose_t::LOST);
  EXPECT_THAT(node_->report().faults, ::testing::Contains(HasSubstr("lost")));
  lidar_until(490);
  EXPECT_FALSE(poses_.back().flags & map_pose_t::LOST) << "the vehicle has not moved: it is found where it was";
  EXPECT_EQ(node_->report().counters["gaps"], 1);
}

TEST_F(LocalizerOnAYard, OnAMapOfAnotherPlaceItIsLostAndStaysSo) {
  config_.map =
      map_file("other.db", test_yard::map_of({.half_length = 8.3, .half_width = 9.4, .turned = -0.5, .curb = 2}));
  begin_ = test_yard::pose_at(-8, -1, 0.2);
  step_ = 0.12;
  for (const auto& start : {std::vector<double>{}, std::vector<double>{-8, -1, 0.2}}) {
    config_.start = start;
    poses_.clear();
    seen_ = 0;
    heard_ = kStart - 50'000;
    begin();
    drive_until(120);
    for (const map_pose_t& pose : poses_) EXPECT_TRUE(pose.flags & map_pose_t::LOST) << pose.revolution;
  }
}

TEST_F(LocalizerOnAYard, AClockThatJumpsIsSurvived) {
  begin();
  drive_until(30);
  ASSERT_FALSE(lost());
  for (const std::int64_t jump : {-3'600'000'000LL, 7'200'000'000LL}) {
    clock_ += jump;
    heard_ = clock_ + seen_ * kRevolution - 50'000;
    drive_until(seen_ + 60);
    EXPECT_FALSE(lost()) << jump;
    EXPECT_LT(error(), 0.05) << jump;
  }
  EXPECT_GE(node_->report().counters["odometry.clock_jumps"], 1);
  EXPECT_EQ(node_->report().counters["lidar.clock_jumps"], 2);
}

TEST_F(LocalizerOnAYard, AGapInOdometryIsSurvived) {
  begin();
  drive_until(30);
  ASSERT_FALSE(lost());
  lidar_until(90);  // 3 s: the map alone holds it
  EXPECT_TRUE(lost() || error() < 0.05);
  EXPECT_GT(node_->report().counters["revolutions.without_odometry"], 40);
  heard_ = kStart + 89 * kRevolution;
  drive_until(150);
  EXPECT_FALSE(lost());
  EXPECT_LT(error(), 0.05);
}

TEST_F(LocalizerOnAYard, ACovarianceOfOdometryThatIsNoneIsCountedAndDoesNoHarm) {
  begin();
  for (; seen_ < 40; ++seen_) {
    for (; heard_ <= kStart + (seen_ + 1) * kRevolution; heard_ += 10'000) {
      odometry_t message = odometry(heard_);
      std::fill(std::begin(message.pose_covariance), std::end(message.pose_covariance),
                std::numeric_limits<float>::quiet_NaN());
      node_->on(message);
    }
    node_->on(packet(seen_));
  }
  bus_.dispatch();
  EXPECT_FALSE(lost());
  for (const float value : poses_.back().covariance) EXPECT_TRUE(std::isfinite(value));
  EXPECT_GT(node_->report().counters["odometry.no_covariance"], 100);
}

TEST_F(LocalizerOnAYard, ATileThatIsGoneInMidDriveIsCountedAndTheDriveGoesOn) {
  begin();
  auto tiles = test_yard::map_of(yard_);
  std::erase_if(tiles, [](const auto& tile) { return tile.key == TileKey{1, 1}; });
  MapStore(config_.map).write({.clear = true, .epoch = 7, .tiles = tiles});
  drive_until(40);
  EXPECT_FALSE(lost());
  EXPECT_LT(error(), 0.05);
  EXPECT_EQ(node_->report().counters["map.unreadable_tiles"], 1);
}

/// By default semantic_map writes the file that the localizer reads. The poses would be in the frame of the new drive.
TEST_F(LocalizerOnAYard, AnotherDriveThatBeginsInTheFileIsNotTheSavedMap) {
  begin();
  MapStore(config_.map).write({.clear = true, .epoch = 8, .tiles = test_yard::map_of(yard_)});
  drive_until(40);
  EXPECT_TRUE(lost());
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("map.db: another drive has begun in this file")));
}

TEST_F(LocalizerOnAYard, RefusesAMapThatIsMissingEmptyOrNone) {
  config_.map = (folder_ / "nowhere.db").string();
  EXPECT_THROW(begin(), MapStoreError);
  config_.map = (folder_ / "none.db").string();
  std::ofstream(config_.map) << "not a map, but long enough to be mistaken for a file of SQLite";
  EXPECT_THROW(begin(), MapStoreError);
  config_.map = (folder_ / "empty.db").string();
  MapStore(config_.map).close_canonical();
  try {
    begin();
    FAIL() << "an empty map was taken";
  } catch (const MapStoreError& error) {
    EXPECT_THAT(error.what(), HasSubstr("empty.db: holds no tiles"));
  }
}

TEST_F(LocalizerOnAYard, RefusesAMapThatIsHalfWrittenCutOffOrNewerAndLeavesItAsItIs) {
  const std::string whole = bytes_of(config_.map);
  ASSERT_GT(whole.size(), 20'000U);
  std::string corrupt = whole, newer = whole;
  for (std::size_t i = 5000; i < 15'000; ++i) corrupt[i] = static_cast<char>(i * 7);
  newer[63] = 99;  // the last byte of user_version in the header of an SQLite file
  const std::vector<std::pair<std::string, std::string>> maps = {
      {"cut.db", whole.substr(0, whole.size() / 2)},
      {"no_bytes.db", ""},
      {"header.db", whole.substr(0, 100)},
      {"corrupt.db", corrupt},
      {"newer.db", newer},
  };
  for (const auto& [name, bytes] : maps) {
    config_.map = (folder_ / name).string();
    std::ofstream(config_.map, std::ios::binary) << bytes;
    try {
      begin();
      ADD_FAILURE() << name << " was taken";
    } catch (const MapStoreError& error) {
      EXPECT_THAT(error.what(), HasSubstr(name));
    }
    EXPECT_EQ(bytes_of(config_.map), bytes) << name;
  }
}

}  // namespace
}  // namespace curbstone::localizer
