#pragma once

#include <array>
#include <cstdint>
#include <curbstone/imu_t.hpp>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/node.hpp"
#include "common/bus/refusal_share.hpp"
#include "common/shell/latency.hpp"
#include "common/time/arrival_gap.hpp"
#include "common/time/clock_offset.hpp"
#include "common/time/recent_times.hpp"
#include "common/time/settling_start.hpp"
#include "drivers/imu/clip_watch.hpp"
#include "drivers/imu/device/imu_device.hpp"
#include "drivers/imu/imu_config.hpp"
#include "drivers/imu/plausibility.hpp"
#include "drivers/imu/receipt_stamps.hpp"
#include "drivers/link/link_state.hpp"

namespace curbstone::imu {

/// Converts the bytes of an IMU to IMU messages. It has no port and no clock: bytes come with their time of receipt (us
/// since the Unix epoch), and commands to the device go to `send`. One thread.
///
/// A sample's stamp is the device's own time, converted to the host's clock by ClockOffset. If the device sends no time
/// it is the time of receipt, spread over the samples of one read (ReceiptStamps). Stamps strictly increase, unless the
/// host's clock is set back. Samples of the first 0.1 s are published at its end (SettlingStart). Implausible samples
/// are withheld, and stuck axes of the gyro are reported in the status (Plausibility).
class ImuNode final : public Node {
 public:
  using Send = device::ImuDevice::Send;

  ImuNode(
      const ImuConfig& config, Publisher& bus, Send send = [](auto) {});

  void connect(Subscriber&) override {}
  void on_bytes(std::int64_t receive_utime, std::span<const std::uint8_t> bytes);
  /// Up: the port was opened again. Down: it has vanished or cannot be opened; `why` is the reason in one line.
  void on_link(std::int64_t now, link::LinkState state, const std::string& why);
  /// Adds to the report: counters and faults of the link.
  void add_report(std::function<void(NodeReport&)> report) { link_report_ = std::move(report); }
  void clock_was_set(std::int64_t by) override;
  void tick(std::int64_t now) override;
  void finish() override;
  [[nodiscard]] NodeReport report() const override;

 private:
  void on_sample(const device::ImuSample& sample);
  void stamp_untimed(std::int64_t receive_utime);
  /// A sample's time on the host's clock, us, and by how much it shows that the samples before were earlier.
  struct HostTime {
    std::int64_t utime;
    std::int64_t earlier;
  };
  void use(const device::ImuSample& sample, HostTime at);
  HostTime to_host(std::int64_t device_time, std::int64_t receive_utime);
  void restart_clock();
  void on_clock_set_back(std::int64_t receive_utime);
  [[nodiscard]] std::int32_t status_of(const device::ImuSample& sample) const;
  void publish(imu_t& message, std::int64_t now);
  void check_garbage(std::int64_t now);
  void count_refusals(std::int64_t now);
  void report_samples(std::vector<std::string>& faults) const;

  ImuConfig config_;
  Publisher& bus_;
  std::unique_ptr<device::ImuDevice> device_;
  ClockOffset clock_;
  bool clock_begun_ = false;
  SettlingStart<imu_t> start_;
  ArrivalGap arrival_;
  ReceiptStamps receipt_stamps_;
  std::vector<device::ImuSample> untimed_;         // of the current read
  static constexpr std::size_t kManyRestarts = 3;  // within a minute
  RecentTimes restarts_{kManyRestarts, 60'000'000};
  std::int32_t sequence_ = -1;
  std::int64_t last_utime_ = 0;  // published

  std::int64_t received_ = 0;  // bytes, of the latest ones

  // for faults, on the clock of tick()
  std::int64_t now_ = 0;
  std::int64_t last_sample_ = 0;
  std::int64_t watched_ = 0;
  std::int64_t watched_bytes_ = 0;
  std::int64_t watched_garbage_ = 0;
  bool garbled_ = false;
  RefusalShare refusals_;
  Counters counted_;  // the device's counters when refusals_ was last updated
  bool self_test_failed_ = false;
  ClipWatch clips_;
  Plausibility plausibility_;
  Plausibility::Verdict verdict_ = Plausibility::Verdict::kGood;
  std::array<double, 3> rate_{};  // rad/s, of the latest sample
  std::string link_fault_;
  std::function<void(NodeReport&)> link_report_;
  LatencyWindow latency_;
  Counters counters_;
};

}  // namespace curbstone::imu
