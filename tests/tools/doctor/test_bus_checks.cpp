#include <gmock/gmock.h>

#include "tools/doctor/checks/bus_checks.hpp"

namespace curbstone::doctor::checks {
namespace {

using ::testing::Each;
using ::testing::Field;
using ::testing::HasSubstr;

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304";

BusFacts sane_bus() {
  BusFacts facts;
  facts.url = kUrl;
  facts.route = RouteFacts{"lo", true, false};
  facts.probe.round_trip = 120;
  facts.probe.granted_buffer = 4194304;
  facts.probe.seconds = 1;
  return facts;
}

/// What a check says; an empty verdict if it is not there.
Verdict verdict_of(const std::string& check, const BusFacts& facts) {
  for (const Verdict& verdict : check_bus(facts)) {
    if (verdict.check == check) return verdict;
  }
  return {Verdict::Kind::kUnknown, "", "", ""};
}

TEST(BusChecks, ASaneBusHasNoFinding) {
  EXPECT_THAT(check_bus(sane_bus()), Each(Field(&Verdict::kind, Verdict::Kind::kGood)));
}

TEST(BusChecks, AMissingRouteIsNamedWithTheCommandThatSetsIt) {
  BusFacts facts = sane_bus();
  facts.route.reset();
  facts.probe = {};
  facts.probe.error = "a message cannot be sent: Network is unreachable";
  const Verdict verdict = verdict_of("route", facts);
  EXPECT_EQ(verdict.kind, Verdict::Kind::kFinding);
  EXPECT_THAT(verdict.fix, HasSubstr("ip route replace 239.255.76.67/32 dev lo"));
  EXPECT_EQ(verdict_of("round trip", facts).what, facts.probe.error);
}

TEST(BusChecks, ABusOfOneHostIsNotToDependOnACable) {
  BusFacts facts = sane_bus();
  facts.route = RouteFacts{"eth0", false, true};
  EXPECT_EQ(verdict_of("route", facts).kind, Verdict::Kind::kFinding);
  EXPECT_EQ(verdict_of("ttl", facts).kind, Verdict::Kind::kGood) << "with ttl 0 nothing leaves the host";
}

TEST(BusChecks, AMessageThatMayLeaveByTheDefaultRouteIsALeak) {
  BusFacts facts = sane_bus();
  facts.url = "udpm://239.255.76.67:7667?ttl=1&recv_buf_size=4194304";
  facts.route = RouteFacts{"wlan0", false, true};
  EXPECT_THAT(verdict_of("ttl", facts).what, HasSubstr("over wlan0"));
  EXPECT_EQ(verdict_of("ttl", facts).kind, Verdict::Kind::kFinding);
  facts.route = RouteFacts{"eth1", false, false};
  EXPECT_EQ(verdict_of("ttl", facts).kind, Verdict::Kind::kGood) << "two hosts, a route of their own";
  EXPECT_EQ(verdict_of("route", facts).kind, Verdict::Kind::kGood);
}

TEST(BusChecks, ASmallerBufferThanAskedForIsAFinding) {
  BusFacts facts = sane_bus();
  facts.probe.granted_buffer = 212992;
  EXPECT_EQ(verdict_of("receive buffer", facts).what, "212992 bytes of 4194304: bursts are lost");
  EXPECT_THAT(verdict_of("receive buffer", facts).fix, HasSubstr("net.core.rmem_max=4194304"));
  facts.url = "udpm://239.255.76.67:7667?ttl=0";
  EXPECT_THAT(verdict_of("receive buffer", facts).what, HasSubstr("the URL asks for none"));
}

TEST(BusChecks, AnotherGroupOnOurPortIsAFinding) {
  BusFacts facts = sane_bus();
  facts.probe.other_groups["239.255.76.68"] = 40;
  EXPECT_THAT(verdict_of("port", facts).what, HasSubstr("40 messages to 239.255.76.68 came on port 7667"));
  EXPECT_EQ(verdict_of("port", facts).kind, Verdict::Kind::kFinding);
}

TEST(BusChecks, SilenceAfterSendingIsAFinding) {
  BusFacts facts = sane_bus();
  facts.probe.round_trip.reset();
  EXPECT_EQ(verdict_of("round trip", facts).kind, Verdict::Kind::kFinding);
}

TEST(BusChecks, AUrlThatIsNoBusIsTheOnlyFinding) {
  BusFacts facts = sane_bus();
  facts.url = "file:///tmp/a.log";
  ASSERT_EQ(check_bus(facts).size(), 1U);
  EXPECT_EQ(check_bus(facts)[0].kind, Verdict::Kind::kFinding);
}

}  // namespace
}  // namespace curbstone::doctor::checks
