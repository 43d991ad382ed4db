#include "services/mapper/local_map/local_map.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper::local_map {
namespace {

/// Counts the keyframes that it is given.
class CountingMap final : public registration::Registration {
 public:
  explicit CountingMap(int& count) : count_(count) {}
  [[nodiscard]] registration::RegistrationResult align(const std::vector<scan::LidarPoint>&,
                                                       const registration::PosePrior&) override {
    return {};
  }
  void insert(const std::vector<scan::LidarPoint>&, const Pose&) override {}
  void insert_keyframe(const scan::Keyframe&) override { ++count_; }
  bool keep_around(const Eigen::Vector3d&) override { return true; }
  [[nodiscard]] double window() const override { return 80; }
  [[nodiscard]] std::vector<registration::ShapeLevel*> levels() override { return {}; }
  [[nodiscard]] std::size_t size() const override { return 0; }

 private:
  int& count_;
};

class LocalMapTest : public ::testing::Test {
 protected:
  LocalMapTest() { (void)tracker_.track(drive_.next(), drive_.odometry); }
  void drive_to(double x) {
    for (; x_ <= x; ++x_) atlas_.visit(test::utime(x_), at(x_), {});
  }
  static Pose at(double x) { return Pose(Eigen::Translation3d(x, 0, 0)); }

  test::MapperDrive drive_;
  tracking::Tracker tracker_{drive_.config.tracker, drive_.config.registration, drive_.config.vehicle, true};
  pose_graph::Atlas atlas_{drive_.config.atlas};
  LocalMap local_map_{atlas_, tracker_};
  double x_ = 0;
};

/// The count of work on the thread that scans wait for.
TEST_F(LocalMapTest, ThatWasBuiltBesideTheScansTakesOnlyTheKeyframesMadeSince) {
  drive_to(40);
  int count = 0;
  NewLocalMap map = build_local_map(atlas_, at(40), atlas_.reference(), std::make_unique<CountingMap>(count));
  EXPECT_EQ(count, 41);
  drive_to(43);
  count = 0;
  local_map_.replace(std::move(map), at(43), atlas_.reference());
  EXPECT_EQ(count, 3);
  for (int id = 0; id < atlas_.size(); ++id) EXPECT_TRUE(atlas_.present(id)) << id;
  EXPECT_TRUE(tracker_.T_map_base().isApprox(at(43)));
}

TEST_F(LocalMapTest, HasTheKeyframeThatTheVehicleIsAtByNow) {
  drive_to(200);
  int count = 0;
  NewLocalMap map = build_local_map(atlas_, at(200), atlas_.reference(), std::make_unique<CountingMap>(count));
  ASSERT_FALSE(atlas_.size() == count) << "the window ends before";
  count = 0;
  local_map_.replace(std::move(map), at(0), 0);
  EXPECT_EQ(count, 1);
  EXPECT_TRUE(atlas_.present(0));
  EXPECT_EQ(atlas_.reference(), 0);
}

}  // namespace
}  // namespace curbstone::mapper::local_map
