#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>

#include "procman/config/config.hpp"
#include "procman/config/config_lexer.hpp"

namespace curbstone::procman::config {

namespace {

constexpr int kMaxGroupDepth = 32;  // bounds the recursion of nested groups
constexpr int kMaxSignal = 64;

bool is_blank(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c) != 0; });
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Recursive descent; each method parses one rule of the grammar.
class Parser {
 public:
  Parser(std::string_view text, const std::string& file) : lexer_(text, file) {}

  Config parse() {
    while (lexer_.peek().kind != TokenKind::kEnd) {
      const Token token = expect(TokenKind::kName, "'cmd', 'group' or 'script'");
      if (token.text == "cmd") {
        command("");
      } else if (token.text == "group") {
        group("", 1);
      } else if (token.text == "script") {
        script();
      } else {
        unexpected(token, "'cmd', 'group' or 'script'");
      }
    }
    return std::move(config_);
  }

 private:
  [[noreturn]] void unexpected(const Token& token, const std::string& wanted) const {
    lexer_.fail(token, fmt::format("expected {}, not {}", wanted, describe(token)));
  }

  Token expect(TokenKind kind, const std::string& wanted) {
    if (lexer_.peek().kind != kind) unexpected(lexer_.peek(), wanted);
    return lexer_.take();
  }

  [[nodiscard]] bool next_is(char punctuation) {
    return lexer_.peek().kind == TokenKind::kPunctuation && lexer_.peek().text[0] == punctuation;
  }

  void expect(char punctuation) {
    if (!next_is(punctuation)) unexpected(lexer_.peek(), fmt::format("'{}'", punctuation));
    lexer_.take();
  }

  bool take_name(std::string_view name) {
    if (lexer_.peek().kind != TokenKind::kName || lexer_.peek().text != name) return false;
    lexer_.take();
    return true;
  }

  /// Value of an integer; digits out of range are an error at their position.
  long integer(const std::string& wanted, long min, long max) {
    const Token token = expect(TokenKind::kInteger, wanted);
    long value = 0;
    const auto result = std::from_chars(token.text.data(), token.text.data() + token.text.size(), value);
    if (result.ec != std::errc() || value < min || value > max) {
      lexer_.fail(token, fmt::format("{} must be from {} to {}", wanted, min, max));
    }
    return value;
  }

  /// Whole seconds, with or without quotes.
  long heartbeat() {
    constexpr const char* kWanted = "heartbeat, whole seconds from 1 to 3600";
    if (lexer_.peek().kind != TokenKind::kString) return integer(kWanted, 1, 3600);
    const Token token = lexer_.take();
    long value = 0;
    const char* const end = token.text.data() + token.text.size();
    const auto result = std::from_chars(token.text.data(), end, value);
    if (result.ec != std::errc() || result.ptr != end || value < 1 || value > 3600) unexpected(token, kWanted);
    return value;
  }

  /// Other words, such as "on", mean no in procman; whoever writes them means yes.
  bool yes_or_no(const std::string& name) {
    const Token token = expect(TokenKind::kString, name + " in quotes");
    const std::string word = lower(token.text);
    if (word == "true" || word == "yes") return true;
    if (word != "false" && word != "no") unexpected(token, fmt::format("{} \"true\" or \"false\"", name));
    return false;
  }

  void refuse_slash(const Token& token, const std::string& what) {
    if (token.text.find('/') != std::string::npos) lexer_.fail(token, what + " cannot contain '/'");
  }

  void group(const std::string& parent, int depth) {
    const Token name = expect(TokenKind::kString, "the group's name in quotes");
    if (is_blank(name.text)) lexer_.fail(name, "a group's name cannot be blank");
    refuse_slash(name, "a group's name");
    if (depth > kMaxGroupDepth) lexer_.fail(name, fmt::format("groups nest deeper than {}", kMaxGroupDepth));
    const std::string path = parent.empty() ? name.text : parent + "/" + name.text;
    expect('{');
    while (!next_is('}')) {
      const Token token = expect(TokenKind::kName, "'cmd', 'group' or '}'");
      if (token.text == "cmd") {
        command(path);
      } else if (token.text == "group") {
        group(path, depth + 1);
      } else {
        unexpected(token, "'cmd', 'group' or '}'");
      }
    }
    expect('}');
  }

  void command(const std::string& enclosing_group) {
    Command command;
    Token at = lexer_.peek();
    command.place.line = at.line;
    if (at.kind == TokenKind::kString) {
      refuse_slash(at, "a command's id");
      command.id = lexer_.take().text;
    }
    expect('{');
    std::map<std::string, int> lines;  // of the attributes so far
    while (!next_is('}')) {
      const Token name = expect(TokenKind::kName, "an attribute or '}'");
      const auto [first, is_new] = lines.emplace(name.text == "host" ? "deputy" : name.text, name.line);
      if (!is_new)
        lexer_.fail(name,
                    fmt::format("cmd \"{}\": {} stands in line {} already", command.id, first->first, first->second));
      expect('=');
      attribute(name, command);
      expect(';');
    }
    if (!lines.contains("exec")) lexer_.fail(lexer_.peek(), fmt::format("cmd \"{}\" has no exec", command.id));
    expect('}');
    if (!enclosing_group.empty()) command.group = enclosing_group;
    config_.commands.push_back(std::move(command));
  }

  void attribute(const Token& name, Command& command) {
    const auto text = [&] { return expect(TokenKind::kString, name.text + " in quotes").text; };
    if (name.text == "exec") {
      command.exec = text();
    } else if (name.text == "deputy" || name.text == "host") {
      command.deputy = text();
    } else if (name.text == "group") {
      command.group = text();
    } else if (name.text == "auto_respawn") {
      command.auto_respawn = yes_or_no("auto_respawn");
    } else if (name.text == "stop_signal") {
      command.stop_signal = static_cast<int>(integer("stop_signal", 1, kMaxSignal));
    } else if (name.text == "stop_time_allowed") {
      command.stop_time_allowed = static_cast<double>(integer("stop_time_allowed", 1, 86400));
    } else if (name.text == "heartbeat") {
      command.heartbeat = static_cast<double>(heartbeat());
    } else {
      lexer_.fail(name, fmt::format("unrecognized attribute '{}'; known are exec, deputy (or host), group, "
                                    "auto_respawn, stop_signal, stop_time_allowed and heartbeat",
                                    name.text));
    }
  }

  void script() {
    const Token name = expect(TokenKind::kString, "the script's name in quotes");
    if (config_.find_script(name.text) != nullptr) {
      lexer_.fail(name, fmt::format("there is already a script \"{}\"", name.text));
    }
    Script script{name.text, {}, {name.line}};
    expect('{');
    while (!next_is('}')) {
      script.actions.push_back(action());
      expect(';');
    }
    expect('}');
    config_.scripts.push_back(std::move(script));
  }

  Action action() {
    constexpr const char* kWanted = "'start', 'stop', 'restart', 'wait', 'run_script' or '}'";
    const Token verb = expect(TokenKind::kName, kWanted);
    Action action;
    action.place.line = verb.line;
    if (verb.text == "run_script") {
      action.kind = ActionKind::kRunScript;
      action.script = expect(TokenKind::kString, "the script's name in quotes").text;
      return action;
    }
    if (verb.text == "wait") return wait(action);
    if (verb.text == "start") {
      action.kind = ActionKind::kStart;
    } else if (verb.text == "stop") {
      action.kind = ActionKind::kStop;
    } else if (verb.text == "restart") {
      action.kind = ActionKind::kRestart;
    } else {
      unexpected(verb, kWanted);
    }
    action.target = take_name("everything") ? Target{} : target("'everything', 'cmd' or 'group'");
    if (take_name("wait")) action.wait_for = status();
    return action;
  }

  Action wait(Action action) {
    if (take_name("ms")) {
      action.kind = ActionKind::kWaitTime;
      action.wait_ms = integer("the wait in ms", 0, 86'400'000);
      return action;
    }
    action.kind = ActionKind::kWaitStatus;
    action.target = target("'ms', 'cmd' or 'group'");
    if (!take_name("status")) unexpected(lexer_.peek(), "'status'");
    action.wait_for = status();
    return action;
  }

  Target target(const std::string& wanted) {
    const Token kind = expect(TokenKind::kName, wanted);
    if (kind.text != "cmd" && kind.text != "group") unexpected(kind, wanted);
    return {kind.text == "cmd" ? TargetKind::kCommand : TargetKind::kGroup,
            expect(TokenKind::kString, "its name in quotes").text};
  }

  WaitStatus status() {
    constexpr const char* kWanted = "\"running\", \"ready\" or \"stopped\"";
    const Token token = expect(TokenKind::kString, kWanted);
    if (token.text == "running") return WaitStatus::kRunning;
    if (token.text == "ready") return WaitStatus::kReady;
    if (token.text == "stopped") return WaitStatus::kStopped;
    unexpected(token, kWanted);
  }

  ConfigLexer lexer_;
  Config config_;
};

}  // namespace

Config parse_config(std::string_view text, const std::string& file) {
  return Parser(text, file).parse();
}

}  // namespace curbstone::procman::config
