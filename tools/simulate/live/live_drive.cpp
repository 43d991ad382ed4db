#include "tools/simulate/live/live_drive.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <future>
#include <memory>

#include "common/time/clock.hpp"
#include "tools/simulate/live/pty.hpp"
#include "tools/simulate/live/udp_sender.hpp"
#include "tools/simulate/rig/emulated_imu.hpp"
#include "tools/simulate/rig/emulated_modbus_wheels.hpp"
#include "tools/simulate/rig/emulated_wheels.hpp"
#include "tools/simulate/rig/packet_spool.hpp"
#include "tools/simulate/sensors/lidar_model.hpp"

namespace curbstone::simulate::live {

namespace {

constexpr std::int64_t kNever = INT64_MAX;
constexpr std::int64_t kSecond = 1'000'000;  // us

/// SIGINT and SIGTERM as a descriptor for poll().
class Signals {
 public:
  Signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &set, &before_);
    fd_ = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
  }
  ~Signals() {
    close(fd_);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
  [[nodiscard]] int fd() const { return fd_; }

 private:
  sigset_t before_{};
  int fd_ = -1;
};

std::unique_ptr<rig::WheelDevice> make_wheels(const rig::Drive& drive, bool modbus) {
  sensors::WheelModel model(drive.config.wheels, drive.config.vehicle, drive.motion, drive.seconds,
                            numerics::Random(drive.seed).fork(12));
  if (modbus) return std::make_unique<rig::EmulatedModbusWheels>(std::move(model));
  return std::make_unique<rig::EmulatedWheels>(std::move(model));
}

/// Raises the priority, because real devices do not wait for any program. It needs the rights; LiveReport::latest shows
/// the result.
void run_before_others() {
  sched_param priority{};
  priority.sched_priority = sched_get_priority_min(SCHED_RR);
  (void)sched_setscheduler(0, SCHED_RR | SCHED_RESET_ON_FORK, &priority);
}

/// The emulated vehicle on the real-time clock, one thread.
class LiveDrive {
 public:
  LiveDrive(const rig::Drive& drive, const LiveOptions& options)
      : drive_(drive),
        options_(options),
        lidar_(devices::make_lidar(drive.lidar, drive.rpm)),
        msop_(options.lidar_host, options.msop_port != 0 ? options.msop_port : lidar_->table().point_port),
        difop_(options.lidar_host, options.difop_port != 0 ? options.difop_port : lidar_->table().info_port),
        imu_port_(options.imu_link),
        can_port_(options.can_link),
        imu_(sensors::ImuModel(drive.config.imu, drive.config.vehicle, drive.motion,
                               numerics::Random(drive.seed).fork(11)),
             options.witmotion),
        wheels_(make_wheels(drive, options.modbus)),
        garbage_(numerics::Random(drive.seed).fork(13)) {
    const auto now = wall_clock();
    send(imu_port_, imu_.power_on(now), rig::SensorFault::Sensor::kImu);
    send(can_port_, wheels_->power_on(now), rig::SensorFault::Sensor::kWheels);
  }

  LiveReport run(const std::function<void(std::int64_t)>& on_start) {
    // The vehicle stands with its devices on until the packets are rendered.
    const int threads = 2;
    auto rendering = std::async(std::launch::async, [&] {
      return std::make_unique<rig::PacketSpool>(drive_, options_.spool, options_.fingerprint, threads, cancel_);
    });
    while (!report_.interrupted && rendering.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
      serve(wall_clock() + 20'000);
    if (report_.interrupted) {
      cancel_ = true;
      rendering.wait();
      return report_;
    }
    spool_ = rendering.get();
    run_before_others();
    start_ = report_.start_utime = wall_clock() + 100'000 + static_cast<std::int64_t>(options_.head_start * 1e6);
    next_difop_ = start_ - 50'000;
    on_start(start_);
    const std::int64_t end = start_ + static_cast<std::int64_t>(drive_.seconds * 1e6);
    while (!report_.interrupted && wall_clock() < end) serve(end);
    report_.seconds = std::max(0.0, std::min(drive_.seconds, time(wall_clock())));
    report_.imu = imu_.samples();
    report_.wheels = wheels_->messages();
    return report_;
  }

 private:
  [[nodiscard]] double time(std::int64_t utime) const {
    return start_ == kNever ? 0.0 : static_cast<double>(utime - start_) * 1e-6;
  }
  [[nodiscard]] std::int64_t packet_due() const {
    if (!spool_ || report_.packets >= spool_->size()) return kNever;
    // A packet is sent after its last shot.
    return start_ + std::llround(static_cast<double>(report_.packets + 1) * lidar_->table().packet_period() * 1e6);
  }

  /// Waits until something is due (at most until `limit`) or the host writes, and handles it.
  void serve(std::int64_t limit) {
    const std::int64_t due = std::min({limit, packet_due(), next_difop_, imu_.next_due(), wheels_->next_due()});
    const std::int64_t wait = std::clamp<std::int64_t>(due - wall_clock(), 0, kSecond);
    pollfd ports[] = {{imu_port_.fd(), POLLIN, 0}, {can_port_.fd(), POLLIN, 0}, {signals_.fd(), POLLIN, 0}};
    const timespec timeout{wait / kSecond, wait % kSecond * 1000};
    if (ppoll(ports, 3, &timeout, nullptr) > 0) {
      if (ports[0].revents != 0)
        send(imu_port_, imu_.on_bytes(wall_clock(), imu_port_.read()), rig::SensorFault::Sensor::kImu);
      if (ports[1].revents != 0)
        send(can_port_, wheels_->on_bytes(wall_clock(), can_port_.read()), rig::SensorFault::Sensor::kWheels);
      if (ports[2].revents != 0) report_.interrupted = true;
    }
    const std::int64_t now = wall_clock();
    // A device samples by its own timer: if this loop is late, the bytes are late but the time of measurement is not.
    for (auto at = imu_.next_due(); at <= now; at = imu_.next_due())
      send(imu_port_, imu_.run(at, time(at)), rig::SensorFault::Sensor::kImu);
    for (auto at = wheels_->next_due(); at <= now; at = wheels_->next_due())
      send(can_port_, wheels_->run(at, time(at)), rig::SensorFault::Sensor::kWheels);
    while (next_difop_ <= now) send_difop(now);
    while (packet_due() <= now) send_packet(now);
  }

  void send_packet(std::int64_t now) {
    const std::int64_t due = packet_due();
    report_.latest = std::max(report_.latest, static_cast<double>(now - due) * 1e-6);
    const auto first_shot =
        start_ + std::llround(static_cast<double>(report_.packets) * lidar_->table().packet_period() * 1e6);
    std::vector<std::uint8_t> packet = spool_->packet(report_.packets++, first_shot);
    if (const auto fault = options_.faults.at(rig::SensorFault::Sensor::kLidar, time(now))) {
      if (fault == rig::SensorFault::Kind::kSilent) return;
      for (auto& byte : packet) byte = static_cast<std::uint8_t>(garbage_.bits());
    }
    msop_.send(packet);
  }

  void send_difop(std::int64_t now) {
    next_difop_ += lidar_->table().info_period;
    if (options_.faults.at(rig::SensorFault::Sensor::kLidar, time(now))) return;
    difop_.send(lidar_->info(now));
  }

  void send(Pty& port, rig::SerialDevice::Bytes bytes, rig::SensorFault::Sensor sensor) {
    if (bytes.empty()) return;
    if (const auto fault = options_.faults.at(sensor, time(wall_clock()))) {
      if (fault == rig::SensorFault::Kind::kSilent) return;
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(garbage_.bits());
    }
    port.write(bytes);
  }

  const rig::Drive& drive_;
  const LiveOptions& options_;
  Signals signals_;
  std::unique_ptr<devices::LidarEmulator> lidar_;
  UdpSender msop_, difop_;
  Pty imu_port_, can_port_;
  rig::EmulatedImu imu_;
  std::unique_ptr<rig::WheelDevice> wheels_;
  numerics::Random garbage_;
  std::atomic<bool> cancel_{false};
  std::unique_ptr<rig::PacketSpool> spool_;
  std::int64_t start_ = kNever;
  std::int64_t next_difop_ = kNever;
  LiveReport report_;
};

}  // namespace

LiveReport run_live(const rig::Drive& drive, const LiveOptions& options,
                    const std::function<void(std::int64_t)>& on_start) {
  return LiveDrive(drive, options).run(on_start);
}

}  // namespace curbstone::simulate::live
