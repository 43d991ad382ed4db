#include "procman/deputy/doctor_run.hpp"

#include <gmock/gmock.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <fstream>

#include "tests/temporary_folder.hpp"

namespace curbstone::procman::deputy {
namespace {

using ::testing::ElementsAre;
using Findings = std::optional<std::vector<std::string>>;

TEST(DoctorFindings, AreTheLinesWithAFix) {
  const Findings found = doctor_findings(R"({"findings": 1, "checks": [
    {"check": "route", "kind": "good", "what": "over lo", "fix": ""},
    {"check": "clock", "kind": "unknown", "what": "?", "fix": "look"},
    {"check": "disk", "kind": "finding", "what": "full", "fix": "delete"}]})");
  ASSERT_TRUE(found);
  EXPECT_THAT(*found, ElementsAre("disk: full; fix: delete"));
}

TEST(DoctorFindings, AreNothingWhenItIsNotAReport) {
  for (const char* text : {"", "{", "[]", "7", R"({"checks": 3})", R"({"checks": [{"kind": "finding"}]})",
                           R"({"checks": [{"kind": "finding", "check": 1, "what": 2, "fix": 3}]})"})
    EXPECT_FALSE(doctor_findings(text)) << text;
}

/// A program of this name before all others.
class DoctorRunTest : public ::testing::Test {
 protected:
  explicit DoctorRunTest() : path_(getenv("PATH")) {}
  ~DoctorRunTest() override { setenv("PATH", path_.c_str(), 1); }
  void program(const std::string& script) {
    std::ofstream(folder_ / "curbstone") << "#!/bin/sh\n" << script << "\n";
    chmod((folder_ / "curbstone").c_str(), 0755);
    setenv("PATH", (folder_.path().string() + ":" + path_).c_str(), 1);
  }
  /// What came out of a run; nothing: it did not end.
  std::optional<DoctorResult> run() {
    EventLoop loop;
    std::optional<DoctorResult> result;
    const DoctorRun doctor(loop, "/etc/x.cfg", "udpm://y", [&](DoctorResult given) {
      result = std::move(given);
      loop.stop();
    });
    loop.every(std::chrono::seconds(60), [&] { loop.stop(); });
    loop.run();
    return result;
  }
  test::TemporaryFolder folder_;
  std::string path_;
};

TEST_F(DoctorRunTest, GivesWhatTheProgramFoundWithTheConfigOfTheDeputy) {
  program(R"(echo '{"checks": [{"kind": "finding", "check": "words", "what": "'"$*"'", "fix": "none"}]}'; exit 1)");
  setenv("CURBSTONE_CONFIG", "/etc/x.yaml", 1);
  const auto result = run();
  ASSERT_TRUE(result && result->findings);
  EXPECT_THAT(*result->findings,
              ElementsAre("words: doctor --json --procman /etc/x.cfg --config /etc/x.yaml --lcm-url udpm://y; "
                          "fix: none"));
}

TEST_F(DoctorRunTest, SaysWhyThereAreNoFindings) {
  const auto why_not = [this] {
    const auto result = run();
    EXPECT_TRUE(result);
    EXPECT_FALSE(result->findings);
    return result->why_not;
  };
  program("kill -9 $$");
  EXPECT_EQ(why_not(), "it ended without a report");
  program("echo 'that' >&2; echo 'this is wrong' >&2; exit 2");
  EXPECT_EQ(why_not(), "this is wrong");
  program("echo no");
  EXPECT_EQ(why_not(), "what it printed is no report");
  setenv("PATH", "/nowhere", 1);
  EXPECT_EQ(why_not(), "curbstone: No such file or directory");
}

}  // namespace
}  // namespace curbstone::procman::deputy
