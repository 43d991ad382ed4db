#include "tools/simulate/log_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "common/log/log_writer.hpp"
#include "drivers/encoder/can/slcan_channel.hpp"
#include "drivers/encoder/encoder_node.hpp"
#include "drivers/imu/imu_node.hpp"
#include "drivers/lidar/lidar_node.hpp"
#include "tools/simulate/rig/emulated_imu.hpp"
#include "tools/simulate/rig/emulated_wheels.hpp"
#include "tools/simulate/sensors/lidar_model.hpp"

namespace curbstone::simulate {

namespace {

constexpr std::int64_t kTick = 20'000;          // us, as in a real process
constexpr std::int64_t kWarmUp = 3'000'000;     // us that the devices run and are configured before the log begins
constexpr std::int64_t kUdpDelay = 120;         // us from a packet's last shot to its reception
constexpr std::int64_t kSerialDelay = 500;      // us, minimum, of a USB serial line
constexpr double kSerialJitter = 400e-6 * 1e6;  // us, mean of the additional delay

/// Publishes every message with the time at which the driver sent it.
class RecordPublisher final : public Publisher {
 public:
  RecordPublisher(const RecordSink& sink, std::int64_t begin) : sink_(sink), begin_(begin) {}
  void set_now(std::int64_t now) { now_ = now; }
  [[nodiscard]] std::int64_t count(const std::string& channel) const {
    const auto it = counts_.find(channel);
    return it == counts_.end() ? 0 : it->second;
  }

 protected:
  void publish_bytes(const std::string& channel, const void* data, int size) override {
    if (now_ < begin_) return;
    sink_(channel, data, size, now_);
    ++counts_[channel];
  }

 private:
  const RecordSink& sink_;
  std::int64_t begin_;
  std::int64_t now_ = 0;
  std::map<std::string, std::int64_t> counts_;
};

/// A serial line: data from the device reach the host with a delay, in order; data from the host arrive at once.
class Line {
 public:
  using Receive = std::function<void(std::int64_t, std::span<const std::uint8_t>)>;
  Line(rig::SerialDevice& device, numerics::Random random) : device_(device), random_(random) {}

  void to_host(std::int64_t now, rig::SerialDevice::Bytes bytes) {
    if (bytes.empty()) return;
    const auto delay =
        kSerialDelay - static_cast<std::int64_t>(kSerialJitter * std::log(1.0 - random_.uniform(0.0, 0.999)));
    last_ = std::max(last_ + 1, now + delay);
    under_way_.emplace(last_, std::move(bytes));
  }
  void to_device(std::span<const std::uint8_t> bytes) { written_.insert(written_.end(), bytes.begin(), bytes.end()); }

  [[nodiscard]] std::int64_t next_due() const {
    const std::int64_t device = device_.next_due();
    return under_way_.empty() ? device : std::min(device, under_way_.begin()->first);
  }
  void serve(std::int64_t now, double t, const Receive& receive) {
    if (device_.next_due() <= now) to_host(now, device_.run(now, t));
    while (!under_way_.empty() && under_way_.begin()->first <= now) {
      receive(now, under_way_.begin()->second);
      under_way_.erase(under_way_.begin());
    }
    if (!written_.empty()) to_host(now, device_.on_bytes(now, std::exchange(written_, {})));
  }

 private:
  rig::SerialDevice& device_;
  numerics::Random random_;
  std::map<std::int64_t, rig::SerialDevice::Bytes> under_way_;
  rig::SerialDevice::Bytes written_;
  std::int64_t last_ = 0;
};

/// The emulated devices and the drivers' nodes on one simulated clock.
class Recorder {
 public:
  Recorder(const rig::Drive& drive, const RecordSink& sink)
      : drive_(drive),
        log_(sink, drive.start_utime),
        surroundings_(drive.make_surroundings()),
        lidar_({drive.rpm, drive.seed, drive.azimuth, drive.start_utime, drive.lidar}, drive.config.vehicle,
               drive.motion, *surroundings_),
        imu_(sensors::ImuModel(drive.config.imu, drive.config.vehicle, drive.motion,
                               numerics::Random(drive.seed).fork(11))),
        wheels_(sensors::WheelModel(drive.config.wheels, drive.config.vehicle, drive.motion, drive.seconds,
                                    numerics::Random(drive.seed).fork(12))),
        imu_line_(imu_, numerics::Random(drive.seed).fork(14)),
        can_line_(wheels_, numerics::Random(drive.seed).fork(15)),
        lidar_node_(lidar_config(drive.lidar), log_, [] { return true; }),  // one simulated clock for host and device
        imu_node_({}, log_, [this](std::span<const std::uint8_t> bytes) { imu_line_.to_device(bytes); }),
        encoder_node_(encoder_config(drive.config), log_,
                      [this](const encoder::can::CanFrame& frame) { channel_.send(frame); }),
        channel_(
            encoder::EncoderConfig{}.bitrate,
            {[this](std::span<const std::uint8_t> bytes) { can_line_.to_device(bytes); },
             [this](std::int64_t utime, const encoder::can::CanFrame& frame) { encoder_node_.on_frame(utime, frame); },
             [this](std::int64_t now) { encoder_node_.on_link(now, link::LinkState::kUp, ""); }}) {}

  Recorded run() {
    const std::int64_t begin = drive_.start_utime - kWarmUp;
    const std::int64_t end = drive_.start_utime + static_cast<std::int64_t>(drive_.seconds * 1e6);
    now_ = begin;
    imu_line_.to_host(now_, imu_.power_on(now_));
    can_line_.to_host(now_, wheels_.power_on(now_));
    imu_node_.on_link(now_, link::LinkState::kUp, "");
    encoder_node_.on_link(now_, link::LinkState::kDown, "");
    channel_.start(now_);
    std::int64_t next_tick = begin, next_difop = begin;
    sensors::LidarModel::Packet packet = lidar_.next();
    for (;;) {
      const std::int64_t packet_due = utime(packet.t_last) + kUdpDelay;
      now_ = std::min({packet_due, next_tick, next_difop, imu_line_.next_due(), can_line_.next_due()});
      if (now_ > end) break;
      log_.set_now(now_);
      if (now_ == next_difop) {
        lidar_node_.on_packet(now_, lidar_.table().info_port, lidar_.info(time(now_)));
        next_difop += lidar_.table().info_period;
      }
      if (now_ == packet_due) {
        lidar_node_.on_packet(now_, lidar_.table().point_port, packet.bytes);
        packet = lidar_.next();
        ++packets_;
      }
      imu_line_.serve(now_, time(now_), [this](auto at, auto bytes) { imu_node_.on_bytes(at, bytes); });
      can_line_.serve(now_, time(now_), [this](auto at, auto bytes) { channel_.on_bytes(at, bytes); });
      if (now_ == next_tick) {
        lidar_node_.tick(now_);
        imu_node_.tick(now_);
        channel_.tick(now_);
        encoder_node_.tick(now_);
        next_tick += kTick;
      }
    }
    return {packets_, log_.count("LIDAR_POINTS"), log_.count("IMU"), log_.count("WHEELS")};
  }

 private:
  [[nodiscard]] static lidar::LidarConfig lidar_config(devices::LidarName name) {
    lidar::LidarConfig config;
    switch (name) {
      case devices::LidarName::kRs16:
        config.model = lidar::models::ModelName::kRs16;
        break;
      case devices::LidarName::kVlp16:
        config.model = lidar::models::ModelName::kVlp16;
        break;
      case devices::LidarName::kHelios16p:
        config.model = lidar::models::ModelName::kHelios16p;
        break;
      case devices::LidarName::kHelios32:
        config.model = lidar::models::ModelName::kHelios32;
        break;
    }
    return config;
  }
  [[nodiscard]] static encoder::EncoderConfig encoder_config(const rig::SimulateConfig& config) {
    encoder::EncoderConfig encoder;
    encoder.counts_per_revolution = config.wheels.counts_per_revolution;
    return encoder;
  }
  [[nodiscard]] std::int64_t utime(double t) const { return drive_.start_utime + std::llround(t * 1e6); }
  [[nodiscard]] double time(std::int64_t at) const { return static_cast<double>(at - drive_.start_utime) * 1e-6; }

  const rig::Drive& drive_;
  RecordPublisher log_;
  std::unique_ptr<sensors::Surroundings> surroundings_;
  sensors::LidarModel lidar_;
  rig::EmulatedImu imu_;
  rig::EmulatedWheels wheels_;
  Line imu_line_, can_line_;
  lidar::LidarNode lidar_node_;
  imu::ImuNode imu_node_;
  encoder::EncoderNode encoder_node_;
  encoder::can::SlcanChannel channel_;
  std::int64_t now_ = 0;
  std::int64_t packets_ = 0;
};

}  // namespace

Recorded record_drive(const rig::Drive& drive, const std::string& log_file) {
  LogWriter log(log_file);
  return record_drive(drive, [&](const std::string& channel, const void* data, int size, std::int64_t log_utime) {
    log.write(channel, data, size, log_utime);
  });
}

Recorded record_drive(const rig::Drive& drive, const RecordSink& sink) {
  return Recorder(drive, sink).run();
}

}  // namespace curbstone::simulate
