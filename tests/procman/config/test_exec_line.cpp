#include "procman/config/exec_line.hpp"

#include <gtest/gtest.h>

#include <map>

namespace curbstone::procman::config {
namespace {

std::optional<std::string> lookup(const std::string& name) {
  static const std::map<std::string, std::string> kVariables = {
      {"HOME", "/root"}, {"A_1", "one"}, {"BLANKS", "a b"}, {"EMPTY", ""}};
  const auto it = kVariables.find(name);
  return it == kVariables.end() ? std::nullopt : std::optional(it->second);
}

struct Case {
  const char* exec;
  std::vector<std::string> argv;
};
class ExecLineWords : public ::testing::TestWithParam<Case> {};

TEST_P(ExecLineWords, AreSplitAsProcmanDoes) {
  const ExecLine line = parse_exec_line(GetParam().exec, lookup);
  EXPECT_EQ(line.error, "");
  EXPECT_EQ(line.argv, GetParam().argv);
}

INSTANTIATE_TEST_SUITE_P(
    Table, ExecLineWords,
    ::testing::Values(Case{"a b  c", {"a", "b", "c"}}, Case{"\ta\n b ", {"a", "b"}},
                      Case{"sh -c 'a b; \"c\"'", {"sh", "-c", "a b; \"c\""}}, Case{"a \"b 'c'\"d", {"a", "b 'c'd"}},
                      Case{"a '' \"\"", {"a", "", ""}}, Case{R"(a b\ c \\ \")", {"a", "b c", "\\", "\""}},
                      Case{R"(a "x\"y" 'it\'s')", {"a", "x\"y", "it's"}},
                      Case{"a $HOME/x ${A_1}2", {"a", "/root/x", "one2"}},
                      Case{"a '$HOME'", {"a", "/root"}},  // quotes do not protect
                      Case{"a $BLANKS$EMPTY", {"a", "a b"}},
                      Case{"a $NO ${NO} $ $1 ${A_1 $-", {"a", "$NO", "${NO}", "$", "$1", "${A_1", "$-"}},
                      Case{R"(a c:\\x)", {"a", "c:\\x"}},  // upstream swallows the x
                      Case{"a b=c", {"a", "b=c"}},
                      Case{"a | b > c && ~ *", {"a", "|", "b", ">", "c", "&&", "~", "*"}}));

TEST(ExecLine, LeadingAssignmentsGoToTheEnvironment) {
  const ExecLine line = parse_exec_line("A=1 B='x y=z' C= D=$HOME prog $A E=2", lookup);
  const std::vector<std::pair<std::string, std::string>> expected = {
      {"A", "1"}, {"B", "x y=z"}, {"C", ""}, {"D", "$HOME"}};
  EXPECT_EQ(line.environment, expected);
  EXPECT_EQ(line.argv, (std::vector<std::string>{"prog", "$A", "E=2"}));
  EXPECT_EQ(line.unknown_variables, (std::vector<std::string>{"A"}));
}

TEST(ExecLine, SaysWhatCannotBeExecuted) {
  for (const char* bad : {"", "  ", "A=1", "a 'b", "a \"b", "a \\", "a '\\'"}) {
    EXPECT_NE(parse_exec_line(bad, lookup).error, "") << bad;
  }
}

}  // namespace
}  // namespace curbstone::procman::config
