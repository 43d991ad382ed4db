#include <gtest/gtest.h>

#include "services/viewer/web/host_rules.hpp"

namespace curbstone::viewer::web {
namespace {

TEST(HostRulesTest, AllowThisMachineAndTheConfiguredNamesAtAnyPort) {
  const HostRules rules({"Robot.local", "10.0.0.7", "[fe80::1]"});
  for (const char* host : {"127.0.0.1", "127.0.0.1:8088", "localhost", "LOCALHOST:1", "[::1]", "[::1]:8088",
                           "robot.local:80", "10.0.0.7", "[fe80::1]:9"})
    EXPECT_TRUE(rules.allows_host(host)) << host;
}

TEST(HostRulesTest, RefuseWhateverElseResolvesToThisMachine) {
  const HostRules rules({"robot.local"});
  for (const char* host : {"", "evil.example", "127.0.0.1.evil.example", "127.evil.example", "localhost.evil.example",
                           "evil.localhost", "robot.local.", "robot.local:", "robot.local:80x", "robot.local:123456",
                           "[::1", "::1", "127.0.0.1:80:80", "user@localhost", " localhost", "127.0.0.2"})
    EXPECT_FALSE(rules.allows_host(host)) << host;
}

TEST(HostRulesTest, OnlyAPageOfTheSameHostMayWatch) {
  const HostRules rules({});
  EXPECT_TRUE(rules.allows_origin("http://localhost:8088", "localhost:8088"));
  EXPECT_TRUE(rules.allows_origin("https://localhost", "LocalHost"));
  for (const char* origin :
       {"", "null", "http://localhost", "http://localhost:8089", "http://127.0.0.1:8088",
        "http://localhost:8088.evil.example", "file://", "localhost:8088", "http://localhost:8088/"})
    EXPECT_FALSE(rules.allows_origin(origin, "localhost:8088")) << origin;
}

}  // namespace
}  // namespace curbstone::viewer::web
