#include <gtest/gtest.h>

#include <random>

#include "procman/config/config.hpp"

namespace curbstone::procman::config {
namespace {

constexpr const char* kSource = R"(# comment
group "g" { group "h" { cmd "a" { exec = "x \"y\" $Z"; host = "d"; auto_respawn = "true"; stop_signal = 15; } } }
cmd "b" { exec = "A=1 b 'c d'"; deputy = "d"; stop_time_allowed = 3; }
script "go" { start group "g/h" wait "running"; wait ms 500; run_script "end"; }
script "end" { wait cmd "a" status "stopped"; stop everything; })";

/// Whatever comes in, either a config or an error with a place inside the text comes out.
void expect_handled(const std::string& text) {
  try {
    const Config config = parse_config(text, "fuzz");
    (void)check_config(config);
    for (const Script& script : config.scripts) (void)check_script(config, script);
  } catch (const ConfigSyntaxError& error) {
    const long lines = 1 + std::count(text.begin(), text.end(), '\n');
    EXPECT_GE(error.line(), 1);
    EXPECT_LE(error.line(), lines);
    EXPECT_GE(error.column(), 1);
    EXPECT_LE(static_cast<std::size_t>(error.column()), text.size() + 1);
  }
}

TEST(ProcmanConfigFuzz, EveryTruncationIsHandled) {
  const std::string source = kSource;
  ASSERT_NO_THROW((void)parse_config(source, "fuzz"));
  for (std::size_t size = 0; size < source.size(); ++size) expect_handled(source.substr(0, size));
}

TEST(ProcmanConfigFuzz, FlippedBitsAndRandomBytesAreHandled) {
  std::mt19937 random(7);
  const std::string source = kSource;
  for (int i = 0; i < 20000; ++i) {
    std::string text = source;
    for (unsigned n = 0; n <= random() % 4; ++n) {
      const std::size_t at = random() % text.size();
      text[at] = static_cast<char>(random() % 2 ? text[at] ^ (1 << random() % 8) : static_cast<int>(random() % 256));
    }
    expect_handled(text);
  }
  for (int i = 0; i < 2000; ++i) {
    std::string text(random() % 200, ' ');
    for (char& c : text) c = static_cast<char>(random() % 256);
    expect_handled(text);
  }
}

TEST(ProcmanConfigFuzz, DeepNestingIsRefusedNotRecursedInto) {
  std::string text;
  for (int i = 0; i < 100000; ++i) text += "group \"g\" {";
  EXPECT_THROW((void)parse_config(text, "deep"), ConfigSyntaxError);
}

}  // namespace
}  // namespace curbstone::procman::config
