#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "common/log/log_files.hpp"
#include "common/log/log_writer.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone {
namespace {

class LogFilesTest : public ::testing::Test {
 protected:
  /// Messages at these times, in ms; each holds its time.
  std::string log(const std::string& name, const std::vector<int>& times) const {
    LogWriter writer(folder_ / name);
    for (const int ms : times) writer.write("IMU", &ms, sizeof ms, std::int64_t{ms} * 1000);
    return folder_ / name;
  }
  static std::vector<int> read(LogFiles& files) {
    std::vector<int> times;
    while (const auto event = files.next()) times.push_back(static_cast<int>(event->log_utime / 1000));
    return times;
  }

  test::TemporaryFolder folder_;
};

TEST_F(LogFilesTest, ASplitDriveIsTheWholeOneEvenIfItsTimesAreNotInOrder) {
  log("drive-001.lcmlog", {250, 290, 280, 400});
  log("drive-000.lcmlog", {100, 200, 300, 260});
  LogFiles files({folder_.path().string()});
  EXPECT_EQ(read(files), (std::vector<int>{100, 200, 300, 260, 250, 290, 280, 400}));
  EXPECT_TRUE(files.notes().empty());
  EXPECT_EQ(files.progress(), 1.0);
}

TEST_F(LogFilesTest, FilesAreReadInTheOrderOfTheirTimesAndAGapIsSaid) {
  const std::string late = log("a.log", {9000, 9100});
  const std::string early = log("b.log", {100, 200});
  LogFiles files({late, early});
  EXPECT_EQ(read(files), (std::vector<int>{100, 200, 9000, 9100}));
  ASSERT_EQ(files.notes().size(), 1U);
  EXPECT_EQ(files.notes()[0], "gap of 8.8 s before " + late);
}

TEST_F(LogFilesTest, FilesOfTheSameTimeAreMergedAndThatIsSaid) {
  const std::string a = log("a.log", {1000, 3000, 5000});
  const std::string b = log("b.log", {2000, 4000, 6000});
  LogFiles files({b, a});
  EXPECT_EQ(read(files), (std::vector<int>{1000, 2000, 3000, 4000, 5000, 6000}));
  ASSERT_EQ(files.notes().size(), 1U);
  EXPECT_EQ(files.notes()[0], b + " overlaps " + a);
}

/// `curbstone log info PIPE` waited for ever for somebody to write.
TEST_F(LogFilesTest, ANamedPipeIsRefusedAtOnce) {
  const std::string pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(LogFiles({pipe}), std::runtime_error);
}

TEST_F(LogFilesTest, AFolderGivesItsLogsAndNothingElse) {
  log("drive-000.lcmlog", {100});
  std::ofstream(folder_ / "drive-001.lcmlog");
  std::ofstream(folder_ / "config.yaml") << "ekf:\n";
  LogFiles files({folder_.path().string()});
  EXPECT_EQ(read(files), (std::vector<int>{100}));
  ASSERT_EQ(files.notes().size(), 1U);
  EXPECT_NE(files.notes()[0].find("drive-001.lcmlog is empty"), std::string::npos);
}

TEST_F(LogFilesTest, AFolderWithoutALogIsOneClearError) {
  EXPECT_THROW(LogFiles({folder_.path().string()}), std::runtime_error);
  EXPECT_THROW(LogFiles({folder_ / "absent"}), std::runtime_error);
}

}  // namespace
}  // namespace curbstone
