#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <sys/resource.h>

#include <csignal>
#include <curbstone/map_points_t.hpp>

#include "common/log/log_writer.hpp"
#include "tests/damaged_file.hpp"
#include "tests/tools/export/exported_map.hpp"

namespace curbstone::map_export {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

using Row = std::array<float, 4>;  // x y z intensity

class Cloud : public ExportedMap {
 protected:
  void SetUp() override {
    ExportedMap::SetUp();
    write_map({}, {});
  }
  /// Points first, first + 1, ... of tile (-2, 5): point k lies k steps along x.
  static map_points_t points(int first, int count, int epoch = kEpoch) {
    map_points_t m{};
    m.utime = 1'000'000;
    m.epoch = epoch;
    m.tile_x = -2;
    m.tile_y = 5;
    m.z_origin = -1;
    m.first = first;
    m.num_points = count;
    for (int k = first; k < first + count; ++k) {
      m.x.push_back(static_cast<std::int16_t>(k));
      m.y.push_back(750);
      m.z.push_back(500);
      m.intensity.push_back(static_cast<std::uint8_t>(10 * k));
    }
    return m;
  }
  static Row row(int k) { return {static_cast<float>(-6 + 0.002 * k), 16.5F, 0, static_cast<float>(10 * k)}; }
  static void append(LogWriter& log, const map_points_t& message) {
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    log.write("MAP_POINTS", bytes.data(), static_cast<int>(bytes.size()));
  }
  void write_log(const std::vector<map_points_t>& messages) const {
    LogWriter log(path("log"));
    for (const map_points_t& message : messages) append(log, message);
  }
  /// As PCL reads it.
  [[nodiscard]] std::vector<Row> read(const std::string& name) const {
    pcl::PCLPointCloud2 blob;
    const int result =
        name.ends_with(".pcd") ? pcl::PCDReader().read(out(name), blob) : pcl::PLYReader().read(out(name), blob);
    EXPECT_GE(result, 0);
    std::vector<Row> rows(std::size_t{blob.width} * blob.height);
    std::size_t found = 0;
    for (const pcl::PCLPointField& field : blob.fields) {
      const auto names = {"x", "y", "z", "intensity"};
      const auto it = std::find(names.begin(), names.end(), field.name);
      if (it == names.end()) continue;
      ++found;
      for (std::size_t i = 0; i < rows.size(); ++i)
        std::memcpy(&rows[i][static_cast<std::size_t>(it - names.begin())],
                    &blob.data[i * blob.point_step + field.offset], 4);
    }
    EXPECT_EQ(found, 4U);
    return rows;
  }
};

TEST_F(Cloud, ComesBackThroughPclAsPcdAndPly) {
  write_log({points(0, 2), points(2, 1)});
  ASSERT_EQ(run({"--only", "cloud", "--log", path("log")}), 0);
  EXPECT_THAT(read("cloud.pcd"), ElementsAre(row(0), row(1), row(2)));
  ASSERT_EQ(run({"--only", "cloud", "--log", path("log"), "--cloud-format", "ply"}), 0);
  EXPECT_THAT(read("cloud.ply"), ElementsAre(row(0), row(1), row(2)));
}

TEST_F(Cloud, OnAFullDiskIsAnErrorAndNoFile) {
  write_log({points(0, 100)});
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit full{1000, before.rlim_max};
  for (const std::string format : {"pcd", "ply"}) {
    setrlimit(RLIMIT_FSIZE, &full);
    EXPECT_ANY_THROW(run({"--only", "cloud", "--log", path("log"), "--cloud-format", format})) << format;
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_FALSE(std::filesystem::exists(out("cloud." + format)));
  }
}

TEST_F(Cloud, TakesRepeatedLateAndOverlappingPiecesOnceAndCountsWhatIsMissing) {
  write_log({points(4, 2), points(0, 2), points(0, 2), points(0, 1), points(1, 2), points(0, 5, kEpoch - 1)});
  ASSERT_EQ(run({"--only", "cloud", "--log", path("log")}), 0);
  EXPECT_THAT(read("cloud.pcd"), ElementsAre(row(0), row(1), row(2), row(4), row(5)));
  EXPECT_THAT(said_, HasSubstr("1 points are missing"));
}

TEST_F(Cloud, LeavesOutWhatTheMapTookOutAgain) {
  map_points_t gone = points(1, 2);
  gone.first = 4;
  for (std::int16_t& x : gone.x) x = static_cast<std::int16_t>(-1 - x);
  write_log({points(0, 4), gone, gone});
  ASSERT_EQ(run({"--only", "cloud", "--log", path("log")}), 0);
  EXPECT_THAT(read("cloud.pcd"), ElementsAre(row(0), row(3)));
}

TEST_F(Cloud, RefusesImpossibleMessages) {
  {
    LogWriter log(path("log"));
    append(log, points(0, 1));
    map_points_t bad = points(1, 1);
    bad.first = -5;
    append(log, bad);
    bad.first = 1;
    bad.z_origin = std::numeric_limits<float>::quiet_NaN();
    append(log, bad);
    const std::vector<std::uint8_t> noise(40, 0xff);
    log.write("MAP_POINTS", noise.data(), static_cast<int>(noise.size()));
  }
  ASSERT_EQ(run({"--only", "cloud", "--log", path("log")}), 0);
  EXPECT_THAT(read("cloud.pcd"), ElementsAre(row(0)));
  EXPECT_THAT(said_, HasSubstr("3 messages refused"));
}

TEST_F(Cloud, OfADamagedLogIsWhatCouldBeReadAndTheExitStatusTellsPrograms) {
  std::vector<map_points_t> messages;
  for (int k = 0; k < 20; ++k) messages.push_back(points(k, 1));
  write_log(messages);
  test::damage_middle(path("log"), 100);
  EXPECT_EQ(run({"--only", "cloud", "--log", path("log")}), 1);
  EXPECT_THAT(said_, HasSubstr("damaged at 1 place: "));
  const std::size_t rows = read("cloud.pcd").size();
  EXPECT_GE(rows, 16U);
  EXPECT_LT(rows, 20U);
}

TEST_F(Cloud, OfAnotherDriveIsRefused) {
  write_log({points(0, 5, 8)});
  EXPECT_THAT(
      [&] {
        run({"--only", "cloud", "--log", path("log")});
      },
      ThrowsMessage<std::exception>(HasSubstr("of epoch 8, the map's epoch is 3")));
  LogWriter(path("log")).write("IMU", std::array<std::uint8_t, 16>{}.data(), 16);
  EXPECT_THAT(
      [&] {
        run({"--only", "cloud", "--log", path("log")});
      },
      ThrowsMessage<std::exception>(HasSubstr("holds no MAP_POINTS")));
  EXPECT_FALSE(std::filesystem::exists(path("out")));
}

}  // namespace
}  // namespace curbstone::map_export
