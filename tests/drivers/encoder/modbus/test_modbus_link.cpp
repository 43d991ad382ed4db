#include "drivers/encoder/modbus/modbus_link.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <curbstone/wheels_t.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "common/statistics/quantile.hpp"
#include "common/time/clock.hpp"
#include "drivers/encoder/modbus_node.hpp"
#include "tests/drivers/driver_on_a_pty.hpp"
#include "tests/drivers/encoder/modbus/modbus_server.hpp"

namespace curbstone::encoder {
namespace {

using namespace std::chrono_literals;
using test::ModbusServer;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;

constexpr bool kRtu = false;
constexpr bool kTcp = true;

/// The driver as the program runs it, and a drive that libmodbus serves, in real time: over TCP, or at the two ends of
/// a pseudo-terminal.
class ModbusDriver : public test::DriverOnAPty<wheels_t> {
 protected:
  ModbusDriver() : DriverOnAPty("WHEELS") {
    loop_.every(20ms, [this] {
      if (node_) node_->tick(wall_clock());
    });
  }
  void start(bool tcp, const std::function<void(EncoderConfig&)>& change = {}) {
    tcp_ = tcp;
    if (tcp)
      server_.emplace();
    else
      server_.emplace(pty_.fd());
    config_.interface = tcp ? Interface::kModbusTcp : Interface::kModbusRtu;
    config_.device = pty_.path();
    config_.modbus.host = "127.0.0.1";
    config_.modbus.port = server_->port();
    if (change) change(config_);
    node_.emplace(config_, recorder_.bus());
    link_.emplace(modbus_settings(config_), config_.modbus.rate);
    node_->add_report([this](NodeReport& report) { link_->report(report); });
    link_->attach(loop_, {[this](const auto& reading) {
                            readings_.push_back(reading);
                            node_->on_reading(wall_clock(), reading);
                          },
                          [this](link::LinkState state, const auto& why) { node_->on_link(state, why); }});
  }
  void unplug() {
    if (tcp_) return server_->drop();
    server_->plug(-1);
    pty_.unplug();
  }
  void plug() {
    if (tcp_) return server_->listen_again();
    pty_.plug();
    server_->plug(pty_.fd());
  }
  [[nodiscard]] NodeReport report() const override { return node_->report(); }
  [[nodiscard]] std::int64_t count(std::string_view name) const { return node_->report().counters[name]; }
  bool run_until_count(const std::string& name, std::int64_t least) {
    return run_until([&] { return count(name) >= least; });
  }
  /// Samples come again, and soon.
  void expect_recovery() {
    const std::int64_t begin = steady_clock();
    EXPECT_TRUE(run_until_more_samples(5));
    EXPECT_LT(steady_clock() - begin, 2'000'000);
    EXPECT_TRUE(run_until_healthy());
  }
  /// In that mood nothing is published, `counter` counts, and it is over soon after.
  void expect_refused(ModbusServer::Mood mood, const std::string& counter) {
    ASSERT_TRUE(run_until_more_samples(10));
    server_->mood = mood;
    ASSERT_TRUE(run_until_count(counter, count(counter) + 3)) << counter;
    ASSERT_TRUE(run_until_fault("no positions"));
    const std::size_t before = recorder_.messages().size();
    ASSERT_TRUE(run_until_count(counter, count(counter) + 3));
    EXPECT_EQ(recorder_.messages().size(), before);
    server_->mood = ModbusServer::Mood::kAnswers;
    expect_recovery();
    expect_true_angles();
  }
  /// What was published is where the wheels were at the stamp, to what the stamp is worth: half of the longest round
  /// trip.
  void expect_true_angles() {
    const auto& all = recorder_.messages();
    constexpr double rate = ModbusServer::kCountsPerSecond;
    for (std::size_t i = 1; i < all.size(); ++i) {
      const double seconds = static_cast<double>(all[i].utime - all[i - 1].utime) * 1e-6;
      if (seconds > config_.silence) continue;  // the counts begin anew
      for (int side = 0; side < 2; ++side)
        EXPECT_NEAR(static_cast<double>(all[i].counts[side] - all[i - 1].counts[side]), rate * seconds, rate * 0.061)
            << i;
    }
  }

  EncoderConfig config_;
  bool tcp_ = false;
  std::optional<ModbusServer> server_;
  std::optional<ModbusNode> node_;
  std::optional<modbus::ModbusLink> link_;
  std::vector<modbus::Reading> readings_;
};

/// Over a serial line and over TCP alike.
class ModbusAnyway : public ModbusDriver, public ::testing::WithParamInterface<bool> {
 protected:
  void SetUp() override { start(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Lines, ModbusAnyway, ::testing::Values(kRtu, kTcp));

TEST_P(ModbusAnyway, TheWheelsAreReadByFunction03Alone) {
  ASSERT_TRUE(run_until_more_samples(100));
  EXPECT_TRUE(run_until_healthy());
  EXPECT_THAT(server_->functions(), ElementsAre(3));
  EXPECT_THAT(server_->blocks(),
              ElementsAre(std::array{0x2030, 1}, std::array{0x20A2, 1}, std::array{0x20A2, 3}, std::array{0x20A5, 8}));
  const auto& messages = recorder_.messages();
  const wheels_t& first = messages[messages.size() - 80];
  const wheels_t& last = messages.back();
  const double seconds = static_cast<double>(last.utime - first.utime) * 1e-6;
  EXPECT_NEAR(static_cast<double>(last.counts[0] - first.counts[0]) / seconds, 10'000, 1'000);
  EXPECT_NEAR(static_cast<double>(last.counts[1] - first.counts[1]) / seconds, 10'000, 1'000);
  EXPECT_TRUE(last.enabled);
  EXPECT_GT(count("modbus.round_trip_us"), 0);
  EXPECT_LT(count("stamp.uncertainty_us"), 60'000);
}

/// The server samples the wheels when a request has come, and answers 40 ms later: half of that before the stamp.
TEST_P(ModbusAnyway, TheStampIsInTheMiddleOfRequestAndReply) {
  server_->lateness = 40;
  server_->mood = ModbusServer::Mood::kLate;
  ASSERT_TRUE(run_until_more_samples(20));
  std::vector<double> after_sampling;  // us
  for (const modbus::Reading& reading : readings_) {
    const double sampled_at = reading.counts[0] / ModbusServer::kCountsPerSecond * 1e6;
    after_sampling.push_back(static_cast<double>(reading.time - server_->began_at()) - sampled_at);
  }
  EXPECT_NEAR(quantile_in_place(after_sampling, 0.5), 20e3, 5e3);
}

TEST_P(ModbusAnyway, FaultsOfTheDriveAreReported) {
  ASSERT_TRUE(run_until_more_samples(10));
  server_->set(0x20A5, 0x0001);
  server_->set(0x20A2, 0xC141);
  EXPECT_TRUE(run_until_fault("drive, left wheel: over-voltage"));
  EXPECT_TRUE(run_until_fault("drive: alarm"));
  server_->set(0x20A5, 0);
  server_->set(0x20A2, 0x4141);
  EXPECT_TRUE(run_until_healthy());
}

TEST_P(ModbusAnyway, ASilentDriveIsAFaultAndIsReadWhenItIsBack) {
  expect_refused(ModbusServer::Mood::kSilent, "refused.timeout");
}

TEST_P(ModbusAnyway, RepliesThatComeTooLateAreNeverTakenForTheNextOne) {
  server_->lateness = 100;
  expect_refused(ModbusServer::Mood::kLate, "refused.timeout");
}

TEST_P(ModbusAnyway, RepliesOfAnotherLengthAreRefused) {
  expect_refused(ModbusServer::Mood::kShort, "refused.malformed");
}

/// A drive without an address is asked for smaller blocks before it is refused.
TEST_P(ModbusAnyway, ADriveWithoutTheAddressesIsRefused) {
  server_->exception = 2;
  expect_refused(ModbusServer::Mood::kException, "refused.illegal_address");
}

TEST_P(ModbusAnyway, ExceptionsAreCountedByTheirCode) {
  ASSERT_TRUE(run_until_more_samples(10));
  server_->exception = 1;
  server_->mood = ModbusServer::Mood::kException;
  ASSERT_TRUE(run_until_fault("no positions"));
  const std::size_t before = recorder_.messages().size();
  for (const auto& [code, counter] : {std::pair{1, "refused.illegal_function"},
                                      {3, "refused.illegal_value"},
                                      {4, "refused.device_failure"},
                                      {11, "refused.exception"}}) {
    server_->exception = code;
    EXPECT_TRUE(run_until_count(counter, count(counter) + 3)) << counter;
  }
  EXPECT_EQ(recorder_.messages().size(), before);
  server_->mood = ModbusServer::Mood::kAnswers;
  expect_recovery();
  expect_true_angles();
}

TEST_P(ModbusAnyway, ADriveThatKnowsNoLargeBlockIsReadBySmallerOnes) {
  server_->most = 4;
  ASSERT_TRUE(run_until_more_samples(50));
  EXPECT_TRUE(run_until_healthy());
  EXPECT_EQ(count("modbus.fallbacks"), 2);
  EXPECT_THAT(server_->blocks(), IsSupersetOf({std::array{0x20A7, 6}, std::array{0x20A7, 4}, std::array{0x20A5, 2}}));
  EXPECT_THAT(server_->functions(), ElementsAre(3));
  expect_true_angles();
}

TEST_P(ModbusAnyway, IsReadAgainAfterItWasUnplugged) {
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(run_until_more_samples(20));
    unplug();
    ASSERT_TRUE(run_until_fault("cannot open Modbus"));
    plug();
    expect_recovery();
  }
  EXPECT_GE(count("link.lost"), 2);
  EXPECT_GE(count("link.reopened"), 2);
  expect_true_angles();
}

TEST_P(ModbusAnyway, MostRepliesRefusedIsAFaultThatNamesTheCause) {
  ASSERT_TRUE(run_until_more_samples(10));
  server_->exception = 4;
  server_->mood = ModbusServer::Mood::kException;
  EXPECT_TRUE(run_until_fault("most of them refused.device_failure"));
}

TEST_P(ModbusAnyway, TheEventLoopNeverWaitsForTheBus) {
  ASSERT_TRUE(run_until_more_samples(10));
  server_->mood = ModbusServer::Mood::kSilent;
  int turns = 0;
  loop_.every(1ms, [&] { ++turns; });
  ASSERT_TRUE(run_until_count("refused.timeout", 5));
  const int before = turns;
  ASSERT_TRUE(run_until_count("refused.timeout", count("refused.timeout") + 5));
  EXPECT_GT(turns - before, 5 * 60 / 10) << "five timeouts of 60 ms";
}

TEST_P(ModbusAnyway, EndsSoonWhateverTheDriveDoes) {
  ASSERT_TRUE(run_until_more_samples(10));
  server_->mood = ModbusServer::Mood::kSilent;
  ASSERT_TRUE(run_until_count("refused.timeout", 1));
  const std::int64_t begin = steady_clock();
  link_.reset();
  EXPECT_LT(steady_clock() - begin, 2'000'000);
}

TEST_F(ModbusDriver, ABadChecksumIsRefused) {
  start(kRtu);
  expect_refused(ModbusServer::Mood::kBadCrc, "refused.crc");
}

TEST_F(ModbusDriver, AReplyOfAnotherSlaveIsRefused) {
  start(kRtu);
  expect_refused(ModbusServer::Mood::kWrongSlave, "refused.wrong_slave");
}

TEST_F(ModbusDriver, IsReadThroughNoise) {
  start(kRtu);
  ASSERT_TRUE(run_until_more_samples(20));
  noise_ = true;
  loop_.every(200ms, [this] { make_noise(5); });
  EXPECT_TRUE(run_until_more_samples(50));
  noise_ = false;
  expect_recovery();
  expect_true_angles();
}

TEST_F(ModbusDriver, AnotherSlaveDoesNotAnswerForIt) {
  start(kRtu, [](EncoderConfig& config) { config.modbus.slave = 7; });
  EXPECT_TRUE(run_until_fault("does not answer"));
  EXPECT_THAT(recorder_.messages(), IsEmpty());
}

TEST_F(ModbusDriver, AGatewayThatIsNotThereAtTheStartIsAFaultAndIsFoundWhenItComes) {
  start(kTcp, [this](EncoderConfig&) {
    server_->drop();
    std::this_thread::sleep_for(50ms);
  });
  ASSERT_TRUE(run_until_fault("cannot open Modbus 127.0.0.1"));
  server_->listen_again();
  expect_recovery();
}

TEST_F(ModbusDriver, AGatewayThatClosesEachConnectionIsNamedAndNotStormed) {
  start(kTcp, [this](EncoderConfig&) { server_->mood = ModbusServer::Mood::kHangsUp; });
  ASSERT_TRUE(run_until_fault("closed by the other end before it gave positions"));
  const std::int64_t begin = steady_clock(), before = count("modbus.openings");
  run_until([&] { return steady_clock() - begin > 1'500'000; });
  EXPECT_LE(count("modbus.openings") - before, 8) << "one a poll would be 75";
  server_->mood = ModbusServer::Mood::kAnswers;
  expect_recovery();
}

TEST(ModbusLink, SettingsThatLibmodbusCannotUseAreRefusedWithTheirKey) {
  const auto why = [](const modbus::ModbusSettings& settings) -> std::string {
    try {
      modbus::ModbusLink(settings, 50);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_THAT(why({.tcp = true, .host = "gateway.local"}), HasSubstr("encoder.modbus.host: 'gateway.local'"));
  EXPECT_THAT(why({.baud = 128000}), HasSubstr("encoder.baud: 128000"));
}

}  // namespace
}  // namespace curbstone::encoder
