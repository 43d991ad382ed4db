// Against the kernel's CAN, on the virtual interface vcan0. Where there is none, can_in_qemu runs these tests inside a
// small virtual machine that has it.
#pragma once

#include <gmock/gmock.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <curbstone/wheels_t.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/time/clock.hpp"
#include "drivers/encoder/can/socketcan_link.hpp"
#include "drivers/encoder/encoder_node.hpp"
#include "tests/drivers/recorder.hpp"
#include "tools/simulate/devices/can_drive_emulator.hpp"

namespace curbstone::encoder::can {

using namespace std::chrono_literals;

inline const char* const kInterface = "vcan0";

inline void set_up(bool up) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq request{};
  std::string(kInterface).copy(request.ifr_name, IFNAMSIZ - 1);
  ioctl(fd, SIOCGIFFLAGS, &request);
  request.ifr_flags = static_cast<short>(up ? request.ifr_flags | IFF_UP : request.ifr_flags & ~IFF_UP);
  ioctl(fd, SIOCSIFFLAGS, &request);
  close(fd);
}

class SocketCanTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (if_nametoindex(kInterface) == 0) GTEST_SKIP() << "no interface vcan0 here: can_in_qemu runs these tests";
  }
};

/// The driver as the program runs it and an emulated drive, both on vcan0, in real time.
class EncoderOnSocketCan : public SocketCanTest {
 public:
  /// Ends with the test.
  class Command {
   public:
    explicit Command(const std::string& command) : pipe_(popen(("exec " + command + " 2>&1").c_str(), "r")) {}
    ~Command() { pclose(pipe_); }
    Command(const Command&) = delete;
    Command& operator=(const Command&) = delete;

   private:
    FILE* pipe_;
  };

 protected:
  void SetUp() override {
    SocketCanTest::SetUp();
    if (IsSkipped()) return;
    open_bus();
    link_.emplace(kInterface, can_ids(config_), [this](const std::string&) { return restart(); });
    node_.emplace(config_, recorder_.bus(), [this](const CanFrame& frame) { link_->send(frame); });
    node_->add_report([this](NodeReport& report) { link_->report(report); });
    link_->attach(loop_, {[this](auto utime, const auto& frame) { node_->on_frame(utime, frame); },
                          [this](auto now, auto state, const auto& why) { node_->on_link(now, state, why); }});
    loop_.every(20ms, [this] { node_->tick(wall_clock()); });
    loop_.every(2ms, [this] { turn_drive(); });
    start_ = steady_clock();
    send(drive_.power_on(start_));
  }
  void open_bus() { bus_.emplace(kInterface, std::vector<std::uint32_t>{0x000, 0x601}); }
  void send(const simulate::devices::CanDriveEmulator::Frames& frames) {
    for (const CanFrame& frame : frames) {
      if (drive_on_) bus_->write(frame);
    }
  }
  /// The drive keeps its own time: what it would have sent while this machine was busy has the counts of then.
  void turn_drive() {
    const std::int64_t now = steady_clock();
    for (auto due = drive_.next_due(); due && *due <= now; due = drive_.next_due()) {
      set_counts(*due);
      send(drive_.tick(*due));
    }
    set_counts(now);  // a start sends at once
    for (auto read = bus_->read(); read.status == CanSocket::Status::kFrame; read = bus_->read()) {
      send(drive_.on_frame(now, read.frame));
    }
  }
  void set_counts(std::int64_t at) {
    const auto counts = static_cast<std::int32_t>((at - start_) / 100);  // 10,000 counts/s
    drive_.set_counts(counts, -counts);
  }
  bool run_until(const std::function<bool()>& done) {
    const std::int64_t deadline = steady_clock() + 20'000'000;
    bool reached = false;
    done_ = [&] {
      reached = done();
      if (reached || steady_clock() > deadline) loop_.stop();
    };
    if (!watching_) loop_.every(10ms, [this] { done_(); });
    watching_ = true;
    loop_.run();
    return reached;
  }
  bool run_until_more_samples(std::size_t more) {
    const std::size_t before = recorder_.messages().size();
    return run_until([&] { return recorder_.messages().size() >= before + more; });
  }

  /// What a controller's driver tells of its errors.
  void send_error(canid_t bits) {
    const int fd = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(kInterface));
    ASSERT_EQ(bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    can_frame frame{};
    frame.can_id = CAN_ERR_FLAG | bits;
    frame.can_dlc = CAN_ERR_DLC;
    ASSERT_EQ(write(fd, &frame, sizeof frame), static_cast<ssize_t>(sizeof frame));
    close(fd);
  }
  std::string restart() {
    restarts_.push_back(steady_clock());
    return why_no_restart_;
  }
  bool run_until_fault(const std::string& text) {
    return run_until([&] {
      for (const auto& fault : node_->report().faults) {
        if (fault.find(text) != std::string::npos) return true;
      }
      return false;
    });
  }

  EncoderConfig config_;
  std::vector<std::int64_t> restarts_;
  std::string why_no_restart_;
  bool drive_on_ = true;
  EventLoop loop_;
  std::optional<CanSocket> bus_;
  simulate::devices::CanDriveEmulator drive_;
  std::int64_t start_ = 0;
  bool watching_ = false;
  std::function<void()> done_;
  test::Recorder<wheels_t> recorder_{"WHEELS"};
  std::optional<SocketCanLink> link_;
  std::optional<EncoderNode> node_;
};

}  // namespace curbstone::encoder::can
