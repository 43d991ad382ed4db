// The network comes late, goes, and comes back while processes run: each in a network namespace of its own.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/system/run_program.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::system_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class LateNetwork : public ::testing::Test {
 protected:
  void SetUp() override {
    if (run_program("unshare -n true").exit_status != 0) GTEST_SKIP() << "may not make a network";
  }
  /// Runs the script where there is no interface but a loopback that is down.
  ProgramResult run(const std::string& script) {
    const std::string file = folder_ / "script";
    write_file(file, "export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=1'\n" + script);
    return run_program("unshare -n sh " + file, 60);
  }
  test::TemporaryFolder folder_;
};

TEST_F(LateNetwork, IsWaitedForWithOneLine) {
  // Each step waits for what the one before must have said: a busy machine takes its time.
  const auto result = run(fmt::format(R"(
said() {{ for i in $(seq 200); do grep -q "$1" '{0}' && return; sleep 0.1; done; }}
curbstone-ekf 2> '{0}' & ekf=$!
said 'is not open'; sleep 2
ip link set lo up; ip route add 239.255.76.67/32 dev lo
said 'over: the bus'
kill $ekf; wait $ekf; status=$?
cat '{0}' >&2; exit $status)",
                                      (folder_ / "err").string()));
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("\nekf: over: the bus udpm://239.255.76.67:7667?ttl=1 is not open")) << "opened";
  const std::string said = "ekf: the bus udpm://239.255.76.67:7667?ttl=1 is not open: Network is unreachable";
  const auto first = result.err.find(said);
  ASSERT_NE(first, std::string::npos) << result.err;
  EXPECT_EQ(result.err.find(said, first + 1), std::string::npos) << "once";
}

TEST_F(LateNetwork, IsWaitedForByTheDeputyAndAllThatItStarts) {
  write_file(folder_ / "x.cfg",
             R"(cmd "ekf" { exec = "curbstone-ekf"; deputy = "x"; auto_respawn = "true"; heartbeat = "4"; })");
  const auto result = run(fmt::format(R"(
timeout --preserve-status -s INT 12 curbstone-deputy --config '{}' --start-all & deputy=$!
sleep 4
ip link set lo up; ip route add 239.255.76.67/32 dev lo
sleep 3
ip link set lo down; sleep 3; ip link set lo up; ip route add 239.255.76.67/32 dev lo
wait $deputy)",
                                      (folder_ / "x.cfg").string()));
  EXPECT_EQ(result.exit_status, 0) << result.out << result.err;
  EXPECT_THAT(result.err, HasSubstr("deputy:x: the bus udpm://")) << "said";
  EXPECT_THAT(result.err, HasSubstr("deputy:x: over: the bus udpm://")) << "and opened";
  EXPECT_THAT(result.out, HasSubstr("deputy: ekf started")) << "the command runs meanwhile";
  EXPECT_THAT(result.out, HasSubstr("ekf: over: the bus udpm://"));
  EXPECT_THAT(result.out, Not(HasSubstr("it hangs"))) << "it is not taken for hanging while nothing can be heard";
}

/// A USB adapter that is pulled out and plugged in, or a veth: the new interface is not the one whose group was joined.
TEST_F(LateNetwork, MayBeRemovedAndMadeAgain) {
  const auto result = run(R"(
up() {
  ip link add bus0 type veth peer name bus1; ip addr add 10.9.0.1/24 dev bus0
  ip link set bus0 up; ip link set bus1 up; ip route replace 239.255.76.67/32 dev bus0
}
up
timeout --preserve-status -s INT 14 curbstone-ekf & first=$!
sleep 2; ip link del bus0; sleep 1; up; sleep 3
timeout --preserve-status -s INT 5 curbstone-ekf 2>/dev/null
wait $first)");
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("ekf: another process has this name")) << "the first one hears the second";
}

}  // namespace
}  // namespace curbstone::system_test
