#include "tools/lidar_tool/points.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "tests/drivers/lidar/captures.hpp"
#include "tests/drivers/lidar/packets.hpp"
#include "tests/paths.hpp"
#include "tests/stamps.hpp"
#include "tools/lidar_tool/lidar_tool.hpp"

namespace curbstone::lidar_tool {
namespace {

using lidar::Bytes;
using lidar::Capture;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

using test::kStart;

/// A sphere of 10 m radius about the lens.
std::vector<Bytes> frames(int count, int sender = 200) {
  std::vector<Bytes> frames;
  for (const auto& each : lidar::drive_packets(kStart, count))
    frames.push_back(lidar::frame(Bytes(each.begin(), each.end()), 6699, 0, sender));
  return frames;
}

/// Records of an RS16's packets, in steps of 5 mm, from 0.4 to 150 m: counted without the driver.
std::int64_t returns_in(const Packets& packets) {
  std::int64_t count = 0;
  packets.for_each([&](const Packet& packet) {
    if (packet.port != 6699) return;
    for (std::size_t record = 0; record < 12UL * 32; ++record) {
      const std::size_t at = 42 + record / 32 * 100 + 4 + record % 32 * 3;
      const int steps = packet.bytes[at] << 8 | packet.bytes[at + 1];
      count += steps >= 80 && steps <= 30'000 ? 1 : 0;
    }
  });
  return count;
}

TEST(LidarPoints, WritesALineForEachPoint) {
  const Capture capture(frames(5), lidar::kEthernet, Capture::Format::kMicroseconds, 1332);
  const auto packets = packets_from(capture.name(), {});
  std::ostringstream out;
  EXPECT_EQ(write_csv(*packets, point_source(*packets, "", ""), out), 5 * 384);
  EXPECT_THAT(out.str(), StartsWith("utime,revolution,x,y,z,intensity,ring\n"));
  std::istringstream lines(out.str());
  std::string line;
  std::getline(lines, line);
  int count = 0;
  for (; std::getline(lines, line); ++count) {
    long long utime = 0;
    int revolution = -1, intensity = 0, ring = 0;
    double x = 0, y = 0, z = 0;
    ASSERT_EQ(
        std::sscanf(line.c_str(), "%lld,%d,%lf,%lf,%lf,%d,%d", &utime, &revolution, &x, &y, &z, &intensity, &ring), 7)
        << line;
    EXPECT_NEAR(std::hypot(x, y, z), 10.04, 0.01);
    EXPECT_EQ(intensity, 100);
    EXPECT_TRUE(ring >= 0 && ring < 16);
  }
  EXPECT_EQ(count, 5 * 384);
}

TEST(LidarPoints, WritesAllPointsOfTheRecording) {
  const std::string recorded = test::data_path("rs16/rs16_washing_house.pcap");
  if (!std::filesystem::exists(recorded)) GTEST_SKIP() << recorded << " is not there";
  const auto packets = packets_from(recorded, {});
  std::ostringstream out;
  const std::int64_t count = write_csv(*packets, point_source(*packets, "", ""), out);
  EXPECT_EQ(count, returns_in(*packets));
  const std::string text = out.str();
  EXPECT_EQ(std::ranges::count(text, '\n'), count + 1);
}

TEST(LidarPoints, WritesOneRevolutionAsPcd) {
  // 20 Hz: 37.5 packets a revolution.
  const Capture capture(frames(120), lidar::kEthernet, Capture::Format::kMicroseconds, 1332);
  const auto packets = packets_from(capture.name(), {});
  const PointSource source = point_source(*packets, "", "rs16");
  std::ostringstream out;
  const std::int64_t count = write_pcd(*packets, source, 1, out);
  EXPECT_NEAR(static_cast<double>(count), 37.5 * 384, 384);
  const std::string text = out.str();
  EXPECT_THAT(text, HasSubstr("FIELDS x y z intensity ring t"));
  EXPECT_THAT(text, HasSubstr("POINTS " + std::to_string(count)));
  const std::size_t data = text.find("DATA binary\n") + 12;
  ASSERT_EQ(text.size() - data, static_cast<std::size_t>(count) * 24);
  float x = 0, y = 0, z = 0, last_time = 0;
  std::memcpy(&x, &text[data], 4);
  std::memcpy(&y, &text[data + 4], 4);
  std::memcpy(&z, &text[data + 8], 4);
  std::memcpy(&last_time, &text[text.size() - 4], 4);
  EXPECT_NEAR(std::hypot(x, y, z), 10.04F, 0.01F);
  EXPECT_NEAR(last_time, 0.05F, 0.0015F) << "a revolution lasts 50 ms";
  EXPECT_THAT([&] { (void)write_pcd(*packets, source, 99, out); },
              ThrowsMessage<std::runtime_error>(HasSubstr("no points in revolution 99: there are 0 to ")));
}

TEST(LidarPoints, TakesTheDeviceThatIsAskedFor) {
  std::vector<Bytes> all = frames(5);
  for (const Bytes& other : frames(2, 201)) all.push_back(other);
  const Capture capture(all, lidar::kEthernet, Capture::Format::kMicroseconds, 1332);
  const auto packets = packets_from(capture.name(), {});
  std::ostringstream out;
  EXPECT_EQ(write_csv(*packets, point_source(*packets, "192.168.1.201", ""), out), 2 * 384);
  EXPECT_THAT([&] { (void)point_source(*packets, "192.168.1.9", ""); },
              ThrowsMessage<std::runtime_error>(HasSubstr("no LiDAR with the address 192.168.1.9")));
  EXPECT_THAT([&] { (void)point_source(*packets, "", "rs999"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("--model rs999")));
}

TEST(LidarPoints, SaysThatTheModelIsAnotherDevices) {
  const Capture capture(frames(5), lidar::kEthernet, Capture::Format::kMicroseconds, 1332);
  const auto packets = packets_from(capture.name(), {});
  std::ostringstream out;
  EXPECT_THAT([&] { (void)write_csv(*packets, point_source(*packets, "", "vlp16"), out); },
              ThrowsMessage<std::runtime_error>(HasSubstr("is --model another device's?")));
}

TEST(LidarPoints, SaysThatThereIsNoLidar) {
  const Capture capture({lidar::frame(Bytes(100), 6699)});
  const auto packets = packets_from(capture.name(), {});
  EXPECT_THAT([&] { (void)point_source(*packets, "", ""); },
              ThrowsMessage<std::runtime_error>(HasSubstr("no LiDAR that this program reads")));
}

int run(std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  return run_lidar(static_cast<int>(argv.size()), argv.data());
}

TEST(LidarPoints, AreNotWrittenOverTheirCapture) {
  const Capture capture(frames(5), lidar::kEthernet, Capture::Format::kMicroseconds, 1332);
  const auto size = std::filesystem::file_size(capture.name());
  for (const char* what : {"csv", "pcd"})
    EXPECT_THAT(
        [&] {
          run({"lidar", what, capture.name(), "--out", capture.name()});
        },
        ThrowsMessage<std::runtime_error>(HasSubstr("is read from")));
  EXPECT_EQ(std::filesystem::file_size(capture.name()), size);
  EXPECT_EQ(run({"lidar", "csv", capture.name(), "--out", capture.name() + ".csv"}), 0);
  EXPECT_GT(std::filesystem::file_size(capture.name() + ".csv"), 5U * 384 * 40);
  std::filesystem::remove(capture.name() + ".csv");
}

/// As `curbstone log csv` of a damaged log does.
TEST(LidarPoints, OfACaptureThatIsCutOffAreWrittenAndItIsSaidOnce) {
  const Capture capture(frames(5), lidar::kEthernet, Capture::Format::kMicroseconds, 1332);
  capture.cut(100);
  const std::string out = capture.name() + ".csv";
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({"lidar", "csv", capture.name(), "--out", out}), 1);
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
  EXPECT_GT(std::filesystem::file_size(out), 4U * 384 * 40);
  std::filesystem::remove(out);
}

}  // namespace
}  // namespace curbstone::lidar_tool
