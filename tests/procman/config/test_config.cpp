#include "procman/config/config.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>

#include "common/resend/recent_messages.hpp"
#include "common/time/microseconds.hpp"
#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::procman::config {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ProcmanConfig, ReadsEveryAttributeAndItsDefaults) {
  const Config config = parse_config(R"(
    cmd "a" { exec = "prog --x \"y z\"\n\\"; deputy = "robot"; auto_respawn = "Yes"; stop_signal = 15; stop_time_allowed = 20; }
    cmd "b" { exec = "b"; host = "other"; auto_respawn = "no"; group = "old/style"; }
  )",
                                     "x.cfg");
  ASSERT_EQ(config.commands.size(), 2U);
  EXPECT_EQ(config.commands[0], (Command{"a", "prog --x \"y z\"\n\\", "robot", "", true, 15, 20}));
  EXPECT_EQ(config.commands[1], (Command{"b", "b", "other", "old/style", false, 2, 7}));
}

/// Whoever maps a hanging process's part of the drive asks for it again, and the senders must have it still.
TEST(ProcmanConfig, OfTheVehicleReplacesWhatHangsBeforeTheSensorsForget) {
  constexpr std::int64_t kBack = 2'500'000;  // us: until the next one asks, and what it maps again
  for (const char* file : {"procman/ugv.cfg", "procman/demo.cfg"}) {
    const Config config = load_config_file(test::source_path(file));
    for (const char* id : {"lidar", "imu", "encoder", "ekf", "mapper"}) {
      const auto command =
          std::find_if(config.commands.begin(), config.commands.end(), [&](const Command& c) { return c.id == id; });
      ASSERT_NE(command, config.commands.end()) << file << ": " << id;
      EXPECT_GE(command->heartbeat, 5) << file << ": " << id << ": a busy machine is no hang";
      EXPECT_LE(microseconds(command->heartbeat) + kBack, KeepLimits{}.span) << file << ": " << id;
    }
  }
}

TEST(ProcmanConfig, ReadsAHeartbeatInQuotesOrNot) {
  EXPECT_EQ(parse_config("cmd \"a\" { exec = \"x\"; heartbeat = \"3\"; }", "f").commands.at(0).heartbeat, 3);
  EXPECT_EQ(parse_config("cmd \"a\" { exec = \"x\"; heartbeat = 3; }", "f").commands.at(0).heartbeat, 3);
  EXPECT_EQ(parse_config("cmd \"a\" { exec = \"x\"; }", "f").commands.at(0).heartbeat, 0);
}

TEST(ProcmanConfig, NestsAndMergesGroups) {
  const Config config = parse_config(R"(
    group "hardware" { cmd "a" { exec = "a"; group = "overwritten"; }
      group "cameras" { cmd "b" { exec = "b"; } } }
    cmd "top" { exec = "t"; }
    group "hardware" { cmd "c" { exec = "c"; } }
    group "hardware2" { cmd "d" { exec = "d"; } }
  )",
                                     "x.cfg");
  EXPECT_EQ(config.find_command("a")->group, "hardware");
  EXPECT_EQ(config.find_command("b")->group, "hardware/cameras");
  EXPECT_THAT(config.resolve({TargetKind::kGroup, "hardware"}), ElementsAre("a", "b", "c"));
  EXPECT_THAT(config.resolve({TargetKind::kGroup, "hardware/cameras"}), ElementsAre("b"));
  EXPECT_THAT(config.resolve({TargetKind::kCommand, "top"}), ElementsAre("top"));
  EXPECT_EQ(config.resolve({}).size(), 5U);
  EXPECT_THAT(config.stages(),
              ElementsAre(ElementsAre("a", "c"), ElementsAre("b"), ElementsAre("top"), ElementsAre("d")));
}

TEST(ProcmanConfig, ReadsScriptsBeforeTheCommandsTheyName) {
  const Config config = parse_config(R"(
    script "go" {
      start group "g" wait "running";  # a comment
      wait ms 500;
      restart cmd "a" wait "stopped";
      wait group "g" status "stopped";
      run_script "end";
    }
    script "end" { stop everything; }
    group "g" { cmd "a" { exec = "a"; deputy = "d"; } })",
                                     "x.cfg");
  ASSERT_EQ(config.scripts.size(), 2U);
  const auto& actions = config.find_script("go")->actions;
  ASSERT_EQ(actions.size(), 5U);
  EXPECT_EQ(actions[0].kind, ActionKind::kStart);
  EXPECT_EQ(actions[0].target.kind, TargetKind::kGroup);
  EXPECT_EQ(actions[0].wait_for, WaitStatus::kRunning);
  EXPECT_EQ(actions[1].wait_ms, 500);
  EXPECT_EQ(actions[2].kind, ActionKind::kRestart);
  EXPECT_EQ(actions[3].kind, ActionKind::kWaitStatus);
  EXPECT_EQ(actions[4].script, "end");
  EXPECT_EQ(config.find_script("end")->actions[0].target.kind, TargetKind::kEverything);
  EXPECT_THAT(check_config(config), ElementsAre());
  EXPECT_THAT(check_script(config, *config.find_script("go")), ElementsAre());
}

TEST(ProcmanConfig, ReadsWhatBothGenerationsWrite) {
  const Config config = parse_config(R"(
group "sensors" {
    cmd "rslidar" { exec = "rslidar_driver --config /etc/robot/rslidar.yaml"; deputy = "robot"; auto_respawn = "true"; }
}
script "go" { start group "sensors" wait "running"; wait ms 500; }
)",
                                     "x.cfg");
  EXPECT_THAT(check_config(config), ElementsAre());
  EXPECT_TRUE(config.commands[0].auto_respawn);
}

TEST(ProcmanConfig, EmptyAndCommentOnlyFilesAreEmptyConfigs) {
  EXPECT_TRUE(parse_config("", "x").commands.empty());
  EXPECT_TRUE(parse_config("# nothing", "x").commands.empty());
}

struct Bad {
  const char* text;
  int line;
  int column;
  const char* says;
};
class ProcmanConfigErrors : public ::testing::TestWithParam<Bad> {};

TEST_P(ProcmanConfigErrors, NameThePlaceAndWhatIsWrong) {
  try {
    (void)parse_config(GetParam().text, "x.cfg");
    FAIL() << "accepted: " << GetParam().text;
  } catch (const ConfigSyntaxError& error) {
    EXPECT_EQ(error.line(), GetParam().line) << error.what();
    EXPECT_EQ(error.column(), GetParam().column) << error.what();
    EXPECT_THAT(error.what(), HasSubstr(GetParam().says));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, ProcmanConfigErrors,
    ::testing::Values(
        Bad{"comand", 1, 1, "expected 'cmd', 'group' or 'script', not 'comand'"},
        Bad{"cmd \"a\" { exec = \"x\" }", 1, 22, "expected ';', not '}'"},
        Bad{"cmd \"a\" {\n  exe = \"x\";\n}", 2, 3, "unrecognized attribute 'exe'"},
        Bad{"cmd \"a\" { deputy = \"x\"; }", 1, 25, "cmd \"a\" has no exec"},
        Bad{"cmd \"a/b\" { exec = \"x\"; }", 1, 5, "cannot contain '/'"},
        Bad{"group \"a/b\" { }", 1, 7, "cannot contain '/'"}, Bad{"group \" \" { }", 1, 7, "cannot be blank"},
        Bad{"group \"\" { }", 1, 7, "cannot be blank"}, Bad{"group g { }", 1, 7, "the group's name in quotes, not 'g'"},
        Bad{"group \"g\" { script \"s\" { } }", 1, 13, "expected 'cmd', 'group' or '}', not 'script'"},
        Bad{"cmd \"a\" { exec = \"x\"; auto_respawn = true; }", 1, 38, "auto_respawn in quotes, not 'true'"},
        Bad{"cmd \"a\" { exec = \"x\"; auto_respawn = \"on\"; }", 1, 38,
            "expected auto_respawn \"true\" or \"false\", not the string \"on\""},
        Bad{"cmd \"a\" { exec = \"x\"; auto_respawn = \"\"; }", 1, 38, "expected auto_respawn \"true\" or \"false\""},
        Bad{"cmd \"a\" { exec = \"x\";\n  exec = \"y\"; }", 2, 3, "cmd \"a\": exec stands in line 1 already"},
        Bad{"cmd \"a\" { exec = \"x\"; host = \"h\";\n  deputy = \"d\"; }", 2, 3, "deputy stands in line 1 already"},
        Bad{"cmd \"a\" { exec = \"x\"; stop_signal = \"2\"; }", 1, 37, "expected stop_signal, not the string \"2\""},
        Bad{"cmd \"a\" { exec = \"x\"; stop_signal = 0; }", 1, 37, "stop_signal must be from 1 to 64"},
        Bad{"cmd \"a\" { exec = \"x\"; stop_signal = 65; }", 1, 37, "from 1 to 64"},
        Bad{"cmd \"a\" { exec = \"x\"; stop_time_allowed = 0; }", 1, 43, "from 1 to"},
        Bad{"cmd \"a\" { exec = \"x\"; heartbeat = \"soon\"; }", 1, 35, "whole seconds from 1 to 3600"},
        Bad{"cmd \"a\" { exec = \"x\"; heartbeat = \"0\"; }", 1, 35, "whole seconds from 1 to 3600"},
        Bad{"cmd \"a\" { exec = \"x\"; heartbeat = 3601; }", 1, 35, "whole seconds from 1 to 3600"},
        Bad{"cmd \"a\" { exec = \"x\"; stop_time_allowed = 1.5; }", 1, 44, "unexpected character '.'"},
        Bad{"cmd \"a\" { exec = \"x\"; stop_time_allowed = -1; }", 1, 43, "unexpected character '-'"},
        Bad{"cmd \"a\" { exec = \"x\"; stop_time_allowed = 99999999999999999999; }", 1, 43, "from 1 to"},
        Bad{"cmd \"a\" { exec = \"x\n\"; }", 1, 18, "no closing quote"}, Bad{"cmd \"a", 1, 5, "no closing quote"},
        Bad{"cmd \"a\\", 1, 5, "no closing quote"}, Bad{"cmd \"a\" {", 1, 10, "not the end of the file"},
        Bad{"cmd \"a\" { exec \"x\"; }", 1, 16, "expected '=', not the string \"x\""},
        Bad{"script \"s\" { wait everything status \"running\"; }", 1, 19, "'ms', 'cmd' or 'group', not 'everything'"},
        Bad{"script \"s\" { wait ms \"5\"; }", 1, 22, "the wait in ms"},
        Bad{"script \"s\" { wait ms -5; }", 1, 22, "'-'"},
        Bad{"script \"s\" { wait cmd \"a\" \"running\"; }", 1, 27, "expected 'status'"},
        Bad{"script \"s\" { start cmd \"a\" wait \"up\"; }", 1, 33, "\"running\", \"ready\" or \"stopped\""},
        Bad{"script \"s\" { begin cmd \"a\"; }", 1, 14, "'run_script' or '}', not 'begin'"},
        Bad{"script \"s\" { start \"a\"; }", 1, 20, "'everything', 'cmd' or 'group'"},
        Bad{"script \"s\" { }\nscript \"s\" { }", 2, 8, "already a script \"s\""},
        Bad{"\xff", 1, 1, "unexpected byte 0xff"}));

TEST(ProcmanConfig, ErrorsShowTheSourceLineAndACaretBelowThePlace) {
  try {
    (void)parse_config("# first\n\tcmd \"a\" { exec = \"x\" }\r\n", "ugv.cfg");
    FAIL();
  } catch (const ConfigSyntaxError& error) {
    EXPECT_STREQ(error.what(),
                 "ugv.cfg:2:23: expected ';', not '}'\n"
                 "  \tcmd \"a\" { exec = \"x\" }\n"
                 "  \t                     ^");
  }
}

TEST(ProcmanConfig, ChecksReportAllThatTheGrammarCannotSee) {
  const Config config = parse_config(R"(
    cmd { exec = "x"; deputy = "d"; }
    cmd "a" { exec = ""; deputy = "d"; }
    cmd "b" { exec = "x 'y"; deputy = "d"; }
    cmd "c" { exec = "x"; }
    cmd "c" { exec = "x"; deputy = "d"; }
    script "s" { start cmd "nobody"; stop group "nothing"; run_script "gone"; }
    script "p" { run_script "q"; }
    script "q" { run_script "p"; }
    script "r" { run_script "p"; }
  )",
                                     "x.cfg");
  EXPECT_THAT(check_config(config),
              ElementsAre("2: a cmd has no id (its exec is \"x\")", "3: cmd \"a\": exec: it names no program",
                          HasSubstr("4: cmd \"b\": exec: a quote"), "5: cmd \"c\" names no deputy",
                          "6: there is already a cmd \"c\", in line 5: ids are unique, over all deputies too"));
  const auto errors_of = [&](const char* script) { return check_script(config, *config.find_script(script)); };
  EXPECT_THAT(errors_of("s"), ElementsAre("7: script \"s\": there is no cmd \"nobody\"",
                                          "7: script \"s\": there is no group \"nothing\"",
                                          "7: script \"s\": there is no script \"gone\""));
  EXPECT_THAT(errors_of("p"), ElementsAre("8: infinite loop: script \"p\" eventually calls itself",
                                          "9: infinite loop: script \"q\" eventually calls itself"));
  EXPECT_THAT(errors_of("r"), ElementsAre("8: infinite loop: script \"p\" eventually calls itself",
                                          "9: infinite loop: script \"q\" eventually calls itself"));
}

/// As in many files of real robots: a group was renamed, and a script was not. Nothing else suffers from it.
TEST(ProcmanConfig, AScriptThatCannotBeRunLeavesTheRestUsable) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "x.cfg")
      << "\xEF\xBB\xBFgroup \"core\" {\r\n  cmd \"a & b (2)\" { exec = \"x\"; host = \"d\"; }\r\n}\r\n"
         "script \"1.start all\" {\r\n  start group \"core\";\r\n  start group \"sensing\";\r\n}\r\n"
         "script \"both\" { wait ms 1; run_script \"1.start all\"; }\r\n"
         "script \"stop\" { stop cmd \"a & b (2)\" wait \"stopped\"; }";
  const Config config = load_config_file(folder / "x.cfg");
  ASSERT_EQ(config.commands.size(), 1U);
  EXPECT_THAT(check_script(config, *config.find_script("stop")), ElementsAre());
  EXPECT_THAT(check_script(config, *config.find_script("both")),
              ElementsAre("6: script \"1.start all\": there is no group \"sensing\""));
  std::ofstream(folder / "y.cfg") << "cmd \"heartbeat\" { exec = \"x\"; host = \"one\"; }\n\n"
                                     "cmd \"heartbeat\" { exec = \"x\"; host = \"two\"; }\n";
  try {
    (void)load_config_file(folder / "y.cfg");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("y.cfg:3: there is already a cmd \"heartbeat\", in line 1"));
  }
}

TEST(ProcmanConfig, OurOwnFilesAreRight) {
  for (const char* name : {"ugv.cfg", "demo.cfg"}) {
    const std::string file = test::source_path("procman/") + name;
    Config config;
    ASSERT_NO_THROW(config = load_config_file(file)) << file;
    EXPECT_GE(config.commands.size(), 7U);
    ASSERT_NE(config.find_script("go"), nullptr);
    for (const Script& script : config.scripts) EXPECT_THAT(check_script(config, script), ElementsAre()) << script.name;
  }
}

TEST(ProcmanConfig, AMissingFileIsOneClearError) {
  try {
    (void)load_config_file("/nowhere/x.cfg");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "/nowhere/x.cfg: cannot read it: No such file or directory");
  }
}

}  // namespace
}  // namespace curbstone::procman::config
