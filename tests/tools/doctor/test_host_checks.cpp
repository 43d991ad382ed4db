#include <gmock/gmock.h>

#include "tools/doctor/checks/host_checks.hpp"

namespace curbstone::doctor::checks {
namespace {

using ::testing::HasSubstr;

HostFacts sane_host() {
  return {{true, 12, 800, {"chronyd"}}, {2, "performance", "acpi-cpufreq"}};
}

TEST(HostChecks, AClockThatNobodySetsIsAFinding) {
  HostFacts facts = sane_host();
  EXPECT_EQ(check_host(facts)[0].kind, Verdict::Kind::kGood);
  EXPECT_THAT(check_host(facts)[0].what, HasSubstr("chronyd: +12 us"));
  facts.clock = {false, 0, 16'000'000, {}};
  EXPECT_EQ(check_host(facts)[0].kind, Verdict::Kind::kFinding);
  EXPECT_EQ(check_host(facts)[0].what, "not synchronised (no program sets it)");
}

TEST(HostChecks, AClockThatIsStillFarOffIsAFinding) {
  HostFacts facts = sane_host();
  facts.clock.offset = -51'000;
  EXPECT_EQ(check_host(facts)[0].kind, Verdict::Kind::kFinding);
  EXPECT_EQ(check_host(facts)[0].what, "-51.0 ms off its source (chronyd)");
}

TEST(HostChecks, PowersaveIsAFindingWhereItKeepsTheCoresSlow) {
  HostFacts facts = sane_host();
  EXPECT_EQ(check_host(facts)[1].kind, Verdict::Kind::kGood);
  facts.processor.governor = "powersave";
  EXPECT_EQ(check_host(facts)[1].kind, Verdict::Kind::kFinding);
  facts.processor.driver = "intel_pstate";
  EXPECT_EQ(check_host(facts)[1].kind, Verdict::Kind::kGood);
}

TEST(HostChecks, OneCoreIsAFinding) {
  HostFacts facts = sane_host();
  facts.processor.cores = 1;
  EXPECT_EQ(check_host(facts)[1].kind, Verdict::Kind::kFinding);
}

}  // namespace
}  // namespace curbstone::doctor::checks
