// Faults of an Xsens that begin and end while the driver runs: errors that it reports, another one in its place, the
// same sample for ever.
#include <gmock/gmock.h>

#include <curbstone/imu_t.hpp>

#include "common/bytes/big_endian.hpp"
#include "drivers/imu/imu_node.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/xsens_emulator.hpp"

namespace curbstone::imu {
namespace {

using simulate::devices::XsensEmulator;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using xsens::encode_xbus;
using xsens::Mid;

using test::kStart;

class XsensFaults : public ::testing::Test {
 protected:
  void make(const ImuConfig& config) {
    node_.emplace(config, recorder_.bus(), [this](std::span<const std::uint8_t> bytes) {
      if (plugged_) answers_ = device_.on_bytes(now_, bytes);
    });
    device_.power_on(now_);
    now_ += 5'000'000;
  }
  /// `us` of a device that measures at 100 Hz.
  void run_for(std::int64_t us) {
    for (const std::int64_t end = now_ + us; now_ < end; now_ += 10'000) {
      const double noise = now_ / 10'000 % 2 == 0 && !frozen_ ? 1e-5 : 0;  // no sensor is still
      if (plugged_ && device_.measuring(now_)) {
        const test::Bytes bytes = device_.sample(
            now_, {.acceleration = {noise, noise, 9.8 + noise}, .angular_rate = {noise, noise, 0.05 + noise}});
        node_->on_bytes(now_ + 200, bytes);
      }
      if (const auto answers = std::exchange(answers_, {}); !answers.empty()) node_->on_bytes(now_ + 300, answers);
      node_->tick(now_ + 400);
    }
  }
  void report_error(std::uint8_t code) { node_->on_bytes(now_, encode_xbus(Mid::kError, std::array{code})); }
  [[nodiscard]] std::vector<std::string> faults() const { return node_->report().faults; }
  [[nodiscard]] std::int64_t count(const char* name) const { return node_->report().counters[name]; }

  test::Recorder<imu_t> recorder_{"IMU"};
  XsensEmulator device_{{.configured = true}};
  std::optional<ImuNode> node_;
  test::Bytes answers_;
  bool plugged_ = true;
  bool frozen_ = false;
  std::int64_t now_ = kStart;
};

class ErrorsOfAnImu : public XsensFaults, public ::testing::WithParamInterface<bool> {};

TEST_P(ErrorsOfAnImu, AreFaultsUntilTheyHaveEnded) {
  make({.configure = GetParam()});
  run_for(2'000'000);
  ASSERT_THAT(faults(), IsEmpty());
  for (int k = 0; k < 20; ++k) {
    report_error(0x29);
    run_for(1'000'000);
    ASSERT_THAT(faults(), ElementsAre(HasSubstr("error 0x29, overflow"))) << k;
  }
  EXPECT_EQ(count("device.errors"), 20);
  run_for(12'000'000);
  EXPECT_THAT(faults(), IsEmpty());
}
INSTANTIATE_TEST_SUITE_P(Configure, ErrorsOfAnImu, ::testing::Bool());

class AnotherImu : public XsensFaults,
                   public ::testing::WithParamInterface<std::tuple<Model, std::int64_t, std::int64_t>> {};

/// Two devices that were switched on together have almost the same time.
TEST_P(AnotherImu, InItsPlaceHasAClockOfItsOwn) {
  const auto& [model, ahead, pause] = GetParam();
  make({.model = model, .configure = false});
  run_for(8'000'000);
  node_->on_link(now_, link::LinkState::kDown, "serial port /dev/x has vanished");
  plugged_ = false;
  run_for(pause);
  plugged_ = true;
  device_ = XsensEmulator({.configured = true});
  device_.power_on(kStart - ahead);
  node_->on_link(now_, link::LinkState::kUp, "");
  const std::size_t before = recorder_.messages().size();
  run_for(8'000'000);
  node_->finish();
  EXPECT_GT(recorder_.messages().size(), before + 790);
  for (std::size_t i = 1; i < recorder_.messages().size(); ++i) {
    const imu_t& message = recorder_.messages()[i];
    EXPECT_GT(message.utime, recorder_.messages()[i - 1].utime);
    EXPECT_LE(std::abs((message.utime - 200 - kStart + 5'000) % 10'000 - 5'000), 100) << i;
  }
  const auto& last = recorder_.messages().back();
  EXPECT_NEAR(static_cast<double>(last.utime), static_cast<double>(now_ - 10'000), 400);
  const auto gap = recorder_.messages()[before].utime - recorder_.messages()[before - 1].utime;
  EXPECT_NEAR(static_cast<double>(gap), static_cast<double>(pause), 45'000);
}
INSTANTIATE_TEST_SUITE_P(Us, AnotherImu,
                         ::testing::Combine(::testing::Values(Model::kXsens, Model::kAuto),
                                            ::testing::Values(-400'000, -30'000, 0, 30'000, 400'000, 3'000'000),
                                            ::testing::Values(200'000, 2'000'000)));

/// The counter and the time go on, and everything else stays what it was.
TEST_F(XsensFaults, TheSameSampleForEverIsWithheldBeforeTheVehicleHasTurned) {
  make({.configure = false});
  run_for(5'000'000);
  const std::size_t before = recorder_.messages().size();
  frozen_ = true;
  run_for(30'000'000);
  EXPECT_LE(recorder_.messages().size(), before + 6);
  EXPECT_THAT(faults(), ElementsAre(HasSubstr("the IMU repeats one sample")));
  EXPECT_GE(count("withheld.frozen"), 2990);
  frozen_ = false;
  run_for(2'000'000);
  EXPECT_THAT(faults(), IsEmpty());
  EXPECT_GE(recorder_.messages().size(), before + 199);
  EXPECT_EQ(count("lost.packets"), 0);
}

/// Without a time the counter alone tells that a message came twice, or late.
TEST_F(XsensFaults, WithoutATimeAMessageThatComesTwiceOrLateIsUsedOnce) {
  make({.configure = false});
  const auto message = [&](int n) {
    test::Bytes payload;
    append_big_endian(payload, std::uint16_t{0x1020});
    payload.push_back(2);
    append_big_endian(payload, static_cast<std::uint16_t>(n));
    for (const std::uint16_t id : {std::uint16_t{0x4020}, std::uint16_t{0x8020}}) {
      append_big_endian(payload, id);
      payload.push_back(12);
      for (int i = 0; i < 3; ++i)
        append_big_endian(payload, std::bit_cast<std::uint32_t>((id == 0x4020 && i == 2 ? 9.8f : 0.f) +
                                                                1e-3f * static_cast<float>(n % 7 + i)));
    }
    return encode_xbus(Mid::kMtData2, payload);
  };
  for (int n = 65'400; n < 65'700; ++n, now_ += 10'000) {
    const int swapped = n % 50 == 20 ? n + 1 : n % 50 == 21 ? n - 1 : n;
    node_->on_bytes(now_, message(swapped));
    if (n % 50 == 10) node_->on_bytes(now_ + 100, message(n));
    node_->tick(now_);
  }
  node_->finish();
  EXPECT_EQ(count("refused.repeated"), 6);
  EXPECT_EQ(count("refused.late"), 6);
  EXPECT_EQ(count("lost.packets"), 0);
  EXPECT_EQ(recorder_.messages().size(), 294U);
  for (std::size_t i = 1; i < recorder_.messages().size(); ++i)
    EXPECT_GT(recorder_.messages()[i].sequence, recorder_.messages()[i - 1].sequence);
  EXPECT_EQ(recorder_.messages().back().sequence, 299);
}

}  // namespace
}  // namespace curbstone::imu
