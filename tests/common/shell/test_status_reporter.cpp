#include "common/shell/status_reporter.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "common/bus/local_bus.hpp"

namespace curbstone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A service whose clocks the test turns.
class StatusOfAService : public ::testing::Test {
 protected:
  StatusOfAService() {
    bus_.subscribe<service_status_t>("SERVICE_STATUS", [this](const service_status_t& s) { heard_ = s; });
  }
  void pass(std::int64_t us, std::int64_t step = 0) {
    steady_ += us;
    wall_ += us + step;
    reporter_.publish(bus_, {}, report_);
    bus_.dispatch();
  }
  std::int64_t steady_ = 5'000'000;
  std::int64_t wall_ = 1'700'000'000'000'000;
  LocalBus bus_;
  NodeReport report_;
  service_status_t heard_{};
  StatusReporter reporter_{"imu", "hash", {[this] { return wall_; }, [this] { return steady_; }}};
};

TEST_F(StatusOfAService, TellsOfAHostClockThatWasSetByMoreThan50MsForAMinute) {
  for (const std::int64_t step : {60'000, -60'000}) {
    for (int i = 0; i < 3; ++i) pass(1'000'000);
    EXPECT_THAT(heard_.fault, IsEmpty());
    pass(1'000'000, step);
    EXPECT_THAT(heard_.fault, ElementsAre(HasSubstr(step > 0 ? "was set by +60 ms" : "was set by -60 ms")));
    for (int i = 0; i < 59; ++i) pass(1'000'000);
    EXPECT_EQ(heard_.fault.size(), 1U);
    for (int i = 0; i < 3; ++i) pass(1'000'000);
    EXPECT_THAT(heard_.fault, IsEmpty());
  }
}

TEST_F(StatusOfAService, TellsWhatOfItsMemoryIsItsOwn) {
  const auto own = [this] {
    pass(1'000'000);
    const auto at = std::ranges::find(heard_.counter_name, "memory.own_kb");
    return at == heard_.counter_name.end() ? 0 : heard_.counter_value.at(std::size_t(at - heard_.counter_name.begin()));
  };
  const std::int64_t before = own();
  EXPECT_GT(before, 0);
  EXPECT_LT(before * 1000, heard_.memory) << "pages of files are not";
#ifdef CURBSTONE_SANITIZED
  GTEST_SKIP() << "a sanitizer keeps memory about memory";
#endif
  const std::vector<char> more(50'000'000, 1);
  EXPECT_NEAR(static_cast<double>(own() - before), 50'000, 3'000) << more.size();
}

TEST_F(StatusOfAService, AClockThatIsSlewedIsNoFault) {
  for (int i = 0; i < 100; ++i) pass(1'000'000, 40'000);
  EXPECT_THAT(heard_.fault, IsEmpty());
}

TEST_F(StatusOfAService, HasOtherFaultsWhenAFaultComesOrGoesAndNotWhenItsNumbersChange) {
  const auto faults_changed = [&](std::vector<std::string> faults) {
    report_.faults = std::move(faults);
    return reporter_.faults_changed(report_);
  };
  report_.faults = {"IMU: nothing heard yet"};
  pass(1'000'000);
  EXPECT_FALSE(faults_changed({"IMU: nothing heard yet"}));
  EXPECT_TRUE(faults_changed({"IMU: silent for 1.2 s"}));
  pass(200'000);
  EXPECT_FALSE(faults_changed({"IMU: silent for 1.4 s"}));
  EXPECT_TRUE(faults_changed({})) << "ready";
  pass(200'000);
  EXPECT_FALSE(faults_changed({}));
}

TEST_F(StatusOfAService, TellsOfAnotherProcessOfItsNameWhileThereIsOne) {
  pass(1'000'000);
  service_status_t other = heard_;
  const auto receive_other = [&](std::int64_t ago) {
    other.utime = wall_ - ago;
    reporter_.on_status(other);
    reporter_.on_status(heard_);
    pass(1'000'000);
  };
  for (int i = 0; i < 3; ++i) receive_other(0);
  EXPECT_THAT(heard_.fault, IsEmpty()) << "that was itself";
  other.pid = heard_.pid + 1;
  receive_other(0);
  EXPECT_THAT(heard_.fault, IsEmpty()) << "a predecessor's last word";
  receive_other(0);
  EXPECT_THAT(heard_.fault, ElementsAre(HasSubstr("another process has this name")));
  for (int i = 0; i < 4; ++i) pass(1'000'000);
  EXPECT_THAT(heard_.fault, IsEmpty());
  for (int i = 0; i < 3; ++i) receive_other(3'600'000'000);
  EXPECT_THAT(heard_.fault, IsEmpty()) << "a log is played";
  other.service = "ekf";
  for (int i = 0; i < 3; ++i) receive_other(0);
  EXPECT_THAT(heard_.fault, IsEmpty());
}

TEST_F(StatusOfAService, TellsOfAnotherProcessOfItsTaskWhileThereIsOne) {
  service_config_t own, other;
  own.service = own.section = other.section = "mapper";
  other.host = "ugv2";
  const auto receive = [&](const std::string& service, std::int64_t ago = 0) {
    other.service = service;
    other.utime = wall_ - ago;
    reporter_.on_config(other, own);
    pass(5'000'000);
  };
  for (int i = 0; i < 3; ++i) receive("mapper");
  EXPECT_THAT(heard_.fault, IsEmpty()) << "that was itself";
  receive("mapper2");
  EXPECT_THAT(heard_.fault, IsEmpty()) << "a predecessor's last word";
  receive("mapper2");
  EXPECT_THAT(heard_.fault,
              ElementsAre("two of mapper are on this bus, and their messages mix: end mapper2 on ugv2, or this one"));
  for (int i = 0; i < 3; ++i) pass(5'000'000);
  EXPECT_THAT(heard_.fault, IsEmpty());
  for (int i = 0; i < 3; ++i) receive("mapper2", 3'600'000'000);
  EXPECT_THAT(heard_.fault, IsEmpty()) << "a log is played";
}

TEST_F(StatusOfAService, SaysTheNodesFaultsAndCounters) {
  report_.faults = {"no packets"};
  report_.counters.add("packets", 3);
  pass(1'000'000);
  EXPECT_THAT(heard_.fault, ElementsAre("no packets"));
  EXPECT_THAT(heard_.counter_name, ElementsAre("packets", "memory.own_kb"));
  EXPECT_THAT(heard_.counter_value, ElementsAre(3, testing::Gt(0)));
  EXPECT_EQ(heard_.uptime, 1'000'000);
}

}  // namespace
}  // namespace curbstone
