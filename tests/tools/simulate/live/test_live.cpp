// Two seconds in real time: the packets over UDP, the serial devices on ptys, configured by the drivers' own code.
#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <filesystem>
#include <thread>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/statistics/quantile.hpp"
#include "common/time/clock.hpp"
#include "drivers/encoder/can/slcan_channel.hpp"
#include "drivers/encoder/encoder_node.hpp"
#include "drivers/imu/imu_node.hpp"
#include "drivers/lidar/lidar_node.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/tools/simulate/drives.hpp"
#include "tools/simulate/live/live_drive.hpp"
#include "tools/simulate/town_surroundings.hpp"

namespace curbstone::simulate::live {
namespace {

int bound_socket(int port) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
  const int size = 4 << 20;
  setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  EXPECT_EQ(bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  return fd;
}

int open_when_there(const std::string& link) {
  for (int i = 0; i < 500; ++i) {
    if (const int fd = open(link.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK); fd >= 0) return fd;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ADD_FAILURE() << link << " never appeared";
  return -1;
}

/// The three drivers' nodes at the host's end of everything, in a thread of the test.
class Host {
 public:
  explicit Host(const live::LiveOptions& options)
      : msop_(bound_socket(options.msop_port)),
        difop_(bound_socket(options.difop_port)),
        options_(options),
        imu_node_({}, bus_,
                  [this](std::span<const std::uint8_t> bytes) { (void)!write(imu_, bytes.data(), bytes.size()); }),
        encoder_node_({}, bus_, [this](const encoder::can::CanFrame& frame) { channel_.send(frame); }),
        channel_(500, {[this](std::span<const std::uint8_t> bytes) { (void)!write(can_, bytes.data(), bytes.size()); },
                       [this](std::int64_t utime, const encoder::can::CanFrame& frame) {
                         encoder_node_.on_frame(utime, frame);
                       },
                       [this](std::int64_t now) { encoder_node_.on_link(now, link::LinkState::kUp, ""); }}) {
    bus_.subscribe<lidar_points_t>("LIDAR_POINTS", [this](const lidar_points_t& m) { lidar.push_back(m.utime); });
    bus_.subscribe<imu_t>("IMU", [this](const imu_t& m) { imu.push_back(m); });
    bus_.subscribe<wheels_t>("WHEELS", [this](const wheels_t&) { ++wheels; });
  }
  ~Host() {
    for (const int fd : {msop_, difop_, imu_, can_}) close(fd);
  }
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;

  void run(const std::atomic<bool>& done) {
    imu_ = open_when_there(options_.imu_link);
    can_ = open_when_there(options_.can_link);
    imu_node_.on_link(wall_clock(), link::LinkState::kUp, "");
    encoder_node_.on_link(wall_clock(), link::LinkState::kDown, "");
    channel_.start(wall_clock());
    while (!done) {
      pollfd ports[] = {{msop_, POLLIN, 0}, {difop_, POLLIN, 0}, {imu_, POLLIN, 0}, {can_, POLLIN, 0}};
      poll(ports, 4, 10);
      for (const auto& port : ports) {
        std::array<std::uint8_t, 4096> buffer;
        for (ssize_t size; (size = read(port.fd, buffer.data(), buffer.size())) > 0;)
          take(port.fd, {buffer.data(), static_cast<std::size_t>(size)});
      }
      const auto now = wall_clock();
      imu_node_.tick(now);
      channel_.tick(now);
      encoder_node_.tick(now);
      bus_.dispatch();
    }
  }

  std::vector<std::int64_t> lidar;
  std::vector<imu_t> imu;
  int wheels = 0;
  [[nodiscard]] Counters counters() const { return lidar_node_.report().counters; }

 private:
  void take(int fd, std::span<const std::uint8_t> bytes) {
    const auto now = wall_clock();
    if (fd == msop_ || fd == difop_)
      lidar_node_.on_packet(now, fd == msop_ ? options_.msop_port : options_.difop_port, bytes);
    if (fd == imu_) imu_node_.on_bytes(now, bytes);
    if (fd == can_) channel_.on_bytes(now, bytes);
  }

  int msop_, difop_, imu_ = -1, can_ = -1;
  const live::LiveOptions& options_;
  LocalBus bus_;
  lidar::LidarNode lidar_node_{{}, bus_};
  imu::ImuNode imu_node_;
  encoder::EncoderNode encoder_node_;
  encoder::can::SlcanChannel channel_;
};

TEST(LiveDrive, IsHeardByTheDriversInRealTime) {
  const test::TemporaryFolder folder;
  live::LiveOptions options;
  options.imu_link = folder / "imu-port";
  options.can_link = folder / "can-port";
  options.msop_port = 46699;
  options.difop_port = 47788;
  options.head_start = 1.5;  // for the drivers to set the devices up
  const rig::SimulateConfig config;
  const rig::Drive drive{test_motion(),
                         [] { return std::make_unique<TownSurroundings>(test_town(), sensors::LidarNoise{}); },
                         config,
                         1200,
                         0,
                         1,
                         2.0,
                         0};
  Host host(options);
  std::atomic<bool> done{false};
  std::thread hearing([&] { host.run(done); });
  std::int64_t start = 0;
  const live::LiveReport report = live::run_live(drive, options, [&](std::int64_t utime) { start = utime; });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  done = true;
  hearing.join();

  EXPECT_FALSE(report.interrupted);
  EXPECT_EQ(report.start_utime, start);
  EXPECT_NEAR(static_cast<double>(report.packets), 2.0 / 0.001332, 2);
  EXPECT_EQ(static_cast<std::int64_t>(host.lidar.size()), report.packets) << "each packet came and was understood";
  ASSERT_FALSE(host.lidar.empty());
  std::vector<double> late;  // us; a busy machine hears some packets late, among them the first
  for (std::size_t i = 0; i < host.lidar.size(); ++i)
    late.push_back(static_cast<double>(host.lidar[i] - start) - 1332.0 * static_cast<double>(i));
  EXPECT_NEAR(quantile_or(late, 0.5, 1e9), 0, 1000) << "stamps are those of the shots";
  EXPECT_NEAR(static_cast<double>(host.lidar.front() - start), 0, 5000);
  EXPECT_NEAR(static_cast<double>(host.lidar.back() - start), 2e6, 5000);
  EXPECT_GT(host.counters()["difop"], 0);
  ASSERT_GT(host.imu.size(), 150U) << "the driver set the IMU up";
  EXPECT_NEAR(host.imu.back().acceleration[2], kGravity, 0.3);
  EXPECT_GT(host.wheels, 150) << "the driver opened the CAN adapter and set the drive up";
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(options.imu_link))) << "nothing stays behind";
}

TEST(LiveDrive, FallsSilentWhenConfigured) {
  const test::TemporaryFolder folder;
  live::LiveOptions options;
  options.imu_link = folder / "imu-port";
  options.can_link = folder / "can-port";
  options.msop_port = 46699;
  options.difop_port = 47788;
  options.faults.add(*rig::parse_fault("lidar-silent:0.5-1"));
  const rig::SimulateConfig config;
  const rig::Drive drive{test_motion(),
                         [] { return std::make_unique<TownSurroundings>(test_town(), sensors::LidarNoise{}); },
                         config,
                         1200,
                         0,
                         1,
                         1.2,
                         0};
  Host host(options);
  std::atomic<bool> done{false};
  std::thread hearing([&] { host.run(done); });
  const live::LiveReport report = live::run_live(drive, options, [](std::int64_t) {});
  done = true;
  hearing.join();
  int in_silence = 0, before = 0, after = 0;
  for (const auto utime : host.lidar) {
    const double t = static_cast<double>(utime - report.start_utime) * 1e-6;
    (t < 0.49 ? before : t > 1.0 ? after : in_silence) += t > 0.51 || t < 0.49 ? 1 : 0;
  }
  EXPECT_GT(before, 300);
  EXPECT_GT(after, 100);
  EXPECT_LT(in_silence, 30) << "a late wake-up may shift the edge a little";
}

}  // namespace
}  // namespace curbstone::simulate::live
