#include "services/localizer/localizer_node.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <curbstone/map_pose_t.hpp>
#include <fstream>
#include <limits>

#include "common/bus/local_bus.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "tests/services/localizer/yard.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::localizer {
namespace {

using semantic_map::store::MapStore;
using semantic_map::store::MapStoreError;
using ::testing::HasSubstr;
using testing::pose_at;
using testing::Yard;

constexpr std::int64_t kStart = 1'750'000'000'000'000;
constexpr std::int64_t kRevolution = 50'000;

class LocalizerOnAYard : public ::testing::Test {
 protected:
  LocalizerOnAYard() {
    config_.map = (folder_ / "map.db").string();
    config_.vehicle.lidar = {0, 0, 0, 0, 0, 0};
    MapStore store(config_.map);
    store.write({.epoch = 7, .tiles = testing::map_of(yard_)});
    store.close_canonical();
    bus_.subscribe<map_pose_t>("LOCALIZED_POSE", [this](const map_pose_t& pose) { poses_.push_back(pose); });
  }
  void begin() {
    node_.emplace(config_, bus_);
    node_->connect(bus_);
  }
  /// The vehicle stands at the origin: its points, and odometry from the beginning to the end of the revolution.
  [[nodiscard]] lidar_points_t packet(int revolution) const {
    lidar_points_t message{};
    message.utime = kStart + revolution * kRevolution;
    message.packet = message.revolution = revolution;
    for (const Eigen::Vector3d& p : testing::points_in(yard_, Pose::Identity())) {
      message.x.push_back(static_cast<float>(p.x()));
      message.y.push_back(static_cast<float>(p.y()));
      message.z.push_back(static_cast<float>(p.z()));
    }
    message.num_points = static_cast<std::int32_t>(message.x.size());
    message.time_offset.assign(message.x.size(), 0.049F);
    message.intensity.assign(message.x.size(), 10);
    message.ring.assign(message.x.size(), 0);
    return message;
  }
  [[nodiscard]] static odometry_t odometry(std::int64_t utime) {
    odometry_t message{};
    message.utime = utime;
    message.orientation[0] = 1;
    message.flags = odometry_t::INITIALISED;
    return message;
  }
  void odometry_until(int revolution) {
    for (; heard_ <= kStart + revolution * kRevolution; heard_ += 10'000) node_->on(odometry(heard_));
    bus_.dispatch();
  }
  void lidar_until(int revolution) {
    for (; seen_ < revolution; ++seen_) node_->on(packet(seen_));
    bus_.dispatch();
  }

  const curbstone::testing::TemporaryFolder folder_;
  Yard yard_;
  LocalizerConfig config_;
  LocalBus bus_;
  std::optional<LocalizerNode> node_;
  std::vector<map_pose_t> poses_;
  std::int64_t heard_ = kStart - 50'000;
  int seen_ = 0;
};

TEST_F(LocalizerOnAYard, SaysAtEachRevolutionsEndWhereItIsInTheSavedMap) {
  begin();
  odometry_until(30);
  lidar_until(31);
  ASSERT_EQ(poses_.size(), 30U);
  EXPECT_TRUE(poses_.front().flags & map_pose_t::LOST) << "not confirmed yet";
  const map_pose_t& last = poses_.back();
  EXPECT_FALSE(last.flags & map_pose_t::LOST);
  EXPECT_EQ(last.utime, kStart + 29 * kRevolution + 49'000);
  EXPECT_EQ(last.epoch, 7);
  EXPECT_LT(std::hypot(last.map_base_position[0], last.map_base_position[1]), 0.02);
  EXPECT_GT(last.inlier_ratio, 0.95F);
}

TEST_F(LocalizerOnAYard, SaysTheSameHoweverTheChannelsInterleave) {
  begin();
  for (int i = 0; i < 20; ++i) {
    odometry_until(i + 1);
    lidar_until(i + 1);
  }
  const auto in_step = std::exchange(poses_, {});
  heard_ = kStart - 50'000;
  seen_ = 0;
  begin();
  odometry_until(3);
  for (int i = 0; i < 20; ++i) {
    lidar_until(i + 1);
    if (i > 3) odometry_until(i - 1);
  }
  odometry_until(20);
  ASSERT_EQ(poses_.size(), in_step.size());
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(poses_[i].map_base_position[k], in_step[i].map_base_position[k]) << i;
    for (int k = 0; k < 36; ++k) EXPECT_EQ(poses_[i].covariance[k], in_step[i].covariance[k]) << i;
    EXPECT_EQ(poses_[i].flags, in_step[i].flags) << i;
  }
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

}  // namespace
}  // namespace curbstone::localizer
