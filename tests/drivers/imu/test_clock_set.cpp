// The host's clock is set while the IMU measures: a moment is lost, and the stamps follow.
#include <gmock/gmock.h>

#include <cmath>
#include <curbstone/imu_t.hpp>

#include "drivers/imu/imu_node.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/wit_emulator.hpp"
#include "tools/simulate/devices/xsens_emulator.hpp"

namespace curbstone::imu {
namespace {

using test::kStart;

struct SetClock {
  bool tells_time;  // an MTi; else a WitMotion as it is bought
  double seconds;
};

class ImuOnASetClock : public ::testing::TestWithParam<SetClock> {
 protected:
  ImuOnASetClock() {
    ImuConfig config;
    config.model = GetParam().tells_time ? Model::kXsens : Model::kWitMotion;
    config.configure = false;
    node_ = std::make_unique<ImuNode>(config, recorder_.bus());
    xsens_.power_on(kStart - 5'000'000);
    wit_.power_on(kStart);
  }
  /// Ticks as the shell does.
  void run_for(double seconds) {
    for (const std::int64_t end = now_ + std::llround(seconds * 1e6); now_ < end; now_ += period()) {
      const double t = static_cast<double>(now_ / period() % 997);
      const simulate::devices::XsensSample sample{
          .acceleration = {std::sin(t), std::cos(t), 9.8 + 0.1 * std::sin(3 * t)},
          .angular_rate = {0.1 * std::sin(t), 0.1 * std::cos(t), 0.2 * std::sin(5 * t)}};
      node_->on_bytes(now_ + set_by_ + 300,
                      GetParam().tells_time ? xsens_.sample(now_, sample) : wit_.sample(now_, sample));
      if (notified_ != set_by_) node_->clock_was_set(set_by_ - notified_);
      notified_ = set_by_;
      node_->tick(now_ + set_by_ + 400);
    }
  }
  [[nodiscard]] std::int64_t period() const { return GetParam().tells_time ? 10'000 : wit_.period(); }

  test::Recorder<imu_t> recorder_{"IMU"};
  simulate::devices::XsensEmulator xsens_{{.configured = true}};
  simulate::devices::WitEmulator wit_;
  std::unique_ptr<ImuNode> node_;
  std::int64_t now_ = kStart;
  std::int64_t set_by_ = 0;
  std::int64_t notified_ = 0;
};

TEST_P(ImuOnASetClock, LosesAMomentAndFollows) {
  run_for(8);
  const std::size_t before = recorder_.messages().size();
  const std::int64_t set_at = now_;
  set_by_ = std::llround(GetParam().seconds * 1e6);
  run_for(8);
  const auto lost = 8'000'000 / period() - static_cast<std::int64_t>(recorder_.messages().size() - before);
  EXPECT_LE(lost * period(), 200'000);
  const imu_t& last = recorder_.messages()[before - 1];
  for (std::size_t i = before; i < recorder_.messages().size(); ++i) {
    const imu_t& m = recorder_.messages()[i];
    const std::int64_t taken = last.utime + (m.sequence - last.sequence) * period();  // on the clock before
    if (taken < set_at + 300'000) continue;
    ASSERT_NEAR(static_cast<double>(m.utime - set_by_), static_cast<double>(taken), 5'000) << i;
  }
  NodeReport report = node_->report();
  EXPECT_GE(report.counters["clock_jumps"] + report.counters["dropped.not_newer"], 1);
}
INSTANTIATE_TEST_SUITE_P(By, ImuOnASetClock,
                         ::testing::Values(SetClock{true, -3600}, SetClock{true, -1}, SetClock{true, -0.5},
                                           SetClock{true, -0.05}, SetClock{true, 0.06}, SetClock{true, 0.5},
                                           SetClock{true, 1}, SetClock{true, 3600}, SetClock{false, -3600},
                                           SetClock{false, -1}, SetClock{false, -0.5}, SetClock{false, 0.5},
                                           SetClock{false, 1}, SetClock{false, 3600}));

}  // namespace
}  // namespace curbstone::imu
