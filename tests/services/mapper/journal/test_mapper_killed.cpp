#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "tests/services/mapper/journal/killed_mapper.hpp"

namespace curbstone::mapper::journal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST_F(KilledMapperTest, IsSucceededInTheSameFrameAndNothingThatWasMappedIsLost) {
  start_mapper();
  drive(60);
  node_->tick(test::utime(100));
  const std::size_t heard = poses_.size();
  const std::int64_t points = counter("dense.points");
  const std::int32_t epoch = poses_.back().epoch;
  const intensity::RingHistograms rings = node_->mapper().rings();
  EXPECT_GE(rings.scans, 20);
  kill_mapper();
  drive(12);
  start_mapper();
  EXPECT_EQ(node_->mapper().rings(), rings) << "one scale of intensities";
  drive(3);
  EXPECT_EQ(counter("resumed"), 1);
  ASSERT_GT(poses_.size(), heard + 14) << "what was driven without a mapper has its place, too";
  EXPECT_LT(poses_[heard].revolution, poses_[heard - 1].revolution) << "it begins before what had not settled";
  for (std::size_t i = heard + 1; i < poses_.size(); ++i) EXPECT_EQ(poses_[i].revolution, poses_[i - 1].revolution + 1);
  EXPECT_EQ(poses_.back().flags & map_pose_t::LOST, 0);
  EXPECT_NE(poses_.back().flags & map_pose_t::REGISTERED, 0);
  EXPECT_LT(error(), 0.08);
  EXPECT_GT(poses_.back().epoch, epoch) << "its tiles are made of other records";
  node_->tick(test::utime(100));
  EXPECT_GT(static_cast<double>(node_->mapper().grown().size()), 0.97 * static_cast<double>(points));

  drive(30);
  EXPECT_LT(error(), 0.1);
  ASSERT_THAT(pages_, Not(IsEmpty()));
  EXPECT_GT(pages_.front().num_poses, static_cast<int>(heard) - 30) << "all of the drive, but what had not settled";
  EXPECT_EQ(pages_.front().utimes.front(), poses_.front().utime);
  EXPECT_THAT(node_->report().faults, IsEmpty());
}

TEST_F(KilledMapperTest, IsSucceededAgainAndAgain) {
  start_mapper();
  drive(40);
  for (int kill = 0; kill < 3; ++kill) {
    kill_mapper();
    drive(6);
    start_mapper();
    drive(20);
    EXPECT_EQ(counter("resumed"), 1) << kill;
    EXPECT_LT(error(), 0.1) << kill;
  }
  EXPECT_EQ(pages_.back().utimes.front(), poses_.front().utime) << "the drive since its beginning";
}

TEST_F(KilledMapperTest, IsSucceededByOneThatIsKilledBeforeItsFirstScan) {
  start_mapper();
  drive(40);
  kill_mapper();
  start_mapper();
  kill_mapper();
  drive(6);
  start_mapper();
  drive(20);
  EXPECT_EQ(counter("resumed"), 1);
  EXPECT_LT(error(), 0.1);
}

TEST_F(KilledMapperTest, IsSucceededAtOnceWhereItsFilterWasKilledToo) {
  start_mapper();
  drive(60);
  const std::size_t heard = poses_.size();
  kill_mapper();
  start_filter();
  drive(12);
  T_odom_start_ = Pose(Eigen::Translation3d(80, -60, 0));
  start_filter();  // what was said meanwhile is lost
  start_mapper();
  drive(40);
  EXPECT_EQ(counter("resumed"), 1) << "the next scan is where the last motion leads";
  EXPECT_EQ(counter("resumed.lost"), 0);
  EXPECT_LT(error(), 0.1);
  for (std::size_t i = heard + 1; i < poses_.size(); ++i) {
    EXPECT_EQ(poses_[i].revolution, poses_[i - 1].revolution + 1) << "none is left out";
    EXPECT_EQ(poses_[i].flags & map_pose_t::LOST, 0);
  }
}

TEST_F(KilledMapperTest, IsSucceededWhereOdometryAndTheLidarBeganAnewToo) {
  start_mapper();
  drive(100);
  kill_mapper();
  drive(10);
  T_odom_start_ = Pose(Eigen::Translation3d(80, -60, 0));
  start_filter();
  start_driver();
  start_mapper();
  drive(60);
  EXPECT_EQ(counter("resumed.lost"), 1);
  EXPECT_EQ(counter("searches.found"), 1) << "sought, and found";
  EXPECT_LT(error(), 0.15);
  EXPECT_EQ(poses_.back().flags & map_pose_t::LOST, 0);
}

TEST_F(KilledMapperTest, IsNotSucceededWhileItLives) {
  start_mapper();
  drive(20);
  LocalBus bus;
  try {
    const MapperNode second(config_, bus);
    FAIL() << "it goes on with a drive that goes on";
  } catch (const JournalError& error) {
    EXPECT_THAT(error.what(), HasSubstr("another mapper keeps it"));
  }
}

/// A local map of one scan a metre differs from one of every scan: its poses lean away, by centimetres in a minute.
TEST_F(KilledMapperTest, IsSucceededByOneWithTheSamePoses) {
  start_mapper();
  drive(120);
  const std::vector<map_pose_t> undisturbed = std::exchange(poses_, {});
  kill_mapper_at_once();
  std::filesystem::remove(config_.journal);
  turn_ = 0;
  odometry_sent_ = -0.1;
  start_driver();
  start_filter();
  start_mapper();
  drive(50);
  for (int kill = 0; kill < 3; ++kill) {
    kill_mapper();
    start_mapper();
    drive(20);
    EXPECT_EQ(counter("resumed.by_keyframes"), 0);
  }
  drive(10);
  ASSERT_EQ(poses_.back().revolution, undisturbed.back().revolution);
  double worst = 0;  // m
  for (const map_pose_t& pose : poses_) {
    const map_pose_t& other = undisturbed[static_cast<std::size_t>(pose.revolution - undisturbed.front().revolution)];
    ASSERT_EQ(other.revolution, pose.revolution);
    const Eigen::Vector3d apart = Eigen::Map<const Eigen::Vector3d>(pose.map_base_position) -
                                  Eigen::Map<const Eigen::Vector3d>(other.map_base_position);
    worst = std::max(worst, apart.norm());
  }
  EXPECT_LT(worst, 0.001);
}

TEST_F(KilledMapperTest, WithoutAFileOfItsLocalMapIsSucceededByKeyframes) {
  start_mapper();
  drive(60);
  kill_mapper();
  EXPECT_TRUE(std::filesystem::remove(config_.journal + ".local_map"));
  start_mapper();
  drive(20);
  EXPECT_EQ(counter("resumed"), 1);
  EXPECT_EQ(counter("resumed.by_keyframes"), 1);
  EXPECT_LT(error(), 0.1);
}

TEST_F(KilledMapperTest, MapsTheSameAsOneWithoutAJournal) {
  start_mapper();
  drive(60);
  const std::int64_t points = counter("dense.points");
  kill_mapper();
  const std::vector<map_pose_t> with = std::exchange(poses_, {});
  config_.journal.clear();
  turn_ = 0;
  odometry_sent_ = -0.1;
  start_mapper();
  drive(60);
  ASSERT_EQ(poses_.size(), with.size());
  for (std::size_t i = 0; i < with.size(); ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(poses_[i].map_base_position[k], with[i].map_base_position[k]);
  }
  EXPECT_EQ(counter("dense.points"), points);
}

TEST_F(KilledMapperTest, LeavesNoJournalWhenTheDriveIsOver) {
  start_mapper();
  drive(20);
  EXPECT_TRUE(std::filesystem::exists(config_.journal));
  node_->finish();
  EXPECT_FALSE(std::filesystem::exists(config_.journal));
  EXPECT_FALSE(std::filesystem::exists(config_.journal + ".local_map"));
}

TEST_F(KilledMapperTest, WhileItWroteLeavesABatchThatIsLeftOut) {
  start_mapper();
  drive(40);
  kill_mapper();
  std::filesystem::resize_file(config_.journal, std::filesystem::file_size(config_.journal) - 7);
  start_mapper();
  drive(20);
  EXPECT_EQ(counter("resumed"), 1);
  EXPECT_LT(error(), 0.1);
}

TEST_F(KilledMapperTest, WhileItBeganTheJournalLeavesTheOneBefore) {
  start_mapper();
  drive(40);
  kill_mapper();
  std::ofstream(config_.journal + ".unfinished") << "half";
  start_mapper();
  drive(20);
  EXPECT_EQ(counter("resumed"), 1);
}

/// What is done to the file, and what the fault says then.
struct Damage {
  const char* name;
  void (*spoil)(const std::string& file);
  const char* fault;
};

class RefusedJournalTest : public KilledMapperTest, public ::testing::WithParamInterface<Damage> {};

TEST_P(RefusedJournalTest, IsAFaultAndANewMapBegins) {
  start_mapper();
  drive(40);
  kill_mapper();
  GetParam().spoil(config_.journal);
  start_mapper();
  drive(20);
  EXPECT_EQ(counter("resumed"), 0);
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr(GetParam().fault)));
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("a new map begins: " + config_.journal)));
  EXPECT_LT(pose_from_arrays(poses_.back().map_base_position, poses_.back().map_base_orientation).translation().norm(),
            4.0)
      << "its frame is where it began";
  EXPECT_NE(poses_.back().flags & map_pose_t::REGISTERED, 0);
  kill_mapper();
  start_mapper();
  drive(5);
  EXPECT_EQ(counter("resumed"), 1) << "of the new drive there is a journal";
}

void flip_a_byte(const std::string& file, std::int64_t from_end) {
  std::fstream f(file, std::ios::in | std::ios::out | std::ios::binary);
  f.seekg(-from_end, std::ios::end);
  const auto byte = static_cast<char>(f.get() ^ 0x10);
  f.seekp(-from_end, std::ios::end);
  f.put(byte);
}

INSTANTIATE_TEST_SUITE_P(
    Journals, RefusedJournalTest,
    ::testing::Values(Damage{"Damaged", [](const std::string& file) { flip_a_byte(file, 5); }, "a checksum is wrong"},
                      Damage{"NoJournal",
                             [](const std::string& file) { std::ofstream(file) << std::string(5000, 'x'); },
                             "is damaged, or no journal"}),
    [](const auto& refused) { return refused.param.name; });

TEST_F(KilledMapperTest, IsNotSucceededTheNextDayOrWhereTheClockWasSetBack) {
  for (const auto hours : {-24, 24}) {
    start_mapper();
    drive(40);
    kill_mapper();
    std::filesystem::last_write_time(config_.journal,
                                     std::filesystem::file_time_type::clock::now() + std::chrono::hours(hours));
    start_mapper();
    drive(10);
    EXPECT_EQ(counter("resumed"), 0);
    EXPECT_EQ(counter("journal.old"), 1);
    EXPECT_THAT(node_->report().faults, IsEmpty()) << "that is how most drives begin";
    kill_mapper();
  }
}

TEST_F(KilledMapperTest, IsNotSucceededByOneOfAnotherVehicle) {
  start_mapper();
  drive(40);
  kill_mapper();
  config_.vehicle.lidar[2] += 0.1;
  start_mapper();
  drive(10);
  EXPECT_EQ(counter("resumed"), 0);
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("is of a mapper with other settings")));
}

TEST_F(KilledMapperTest, CannotBeSucceededWhereThereIsNoJournalAndSaysSo) {
  std::ofstream(folder_ / "a_file") << "no folder";
  config_.journal = folder_ / "a_file/drive.journal";
  start_mapper();
  drive(20);
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("a mapper that dies begins a new map")));
  EXPECT_LT(error(), 0.1) << "it maps all the same";
}

TEST_F(KilledMapperTest, HasABoundedJournal) {
  config_.journal_mb = 1;
  start_mapper();
  for (int i = 0; i < 100; ++i) {
    step();
    if (std::filesystem::exists(config_.journal)) {
      EXPECT_LE(std::filesystem::file_size(config_.journal), 1'000'000U);
    }
  }
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("would be larger than 1 MB")));
  EXPECT_FALSE(std::filesystem::exists(config_.journal)) << "half a drive is none";
}

}  // namespace
}  // namespace curbstone::mapper::journal
