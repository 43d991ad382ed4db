#include "procman/config/config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "procman/config/exec_line.hpp"

namespace curbstone::procman::config {

namespace {

template <class Items, class Key>
auto find_by(const Items& items, std::string_view name, Key key) -> decltype(&items.front()) {
  const auto it = std::find_if(items.begin(), items.end(), [&](const auto& item) { return item.*key == name; });
  return it == items.end() ? nullptr : &*it;
}

bool is_inside(const std::string& group, const std::string& ancestor) {
  return group == ancestor || group.starts_with(ancestor + "/");
}

/// Whether a script calls itself through run_script.
bool calls_itself(const Config& config, const Script& start) {
  std::set<std::string> seen;
  std::vector<const Script*> todo = {&start};
  while (!todo.empty()) {
    const Script* script = todo.back();
    todo.pop_back();
    for (const Action& action : script->actions) {
      if (action.kind != ActionKind::kRunScript) continue;
      if (action.script == start.name) return true;
      const Script* called = config.find_script(action.script);
      if (called != nullptr && seen.insert(action.script).second) todo.push_back(called);
    }
  }
  return false;
}

/// Adds what is wrong with one script, without those that it runs.
void check_actions(const Config& config, const Script& script, std::vector<std::string>& errors) {
  for (const Action& action : script.actions) {
    if (action.kind == ActionKind::kRunScript) {
      if (config.find_script(action.script) == nullptr) {
        errors.push_back(
            fmt::format("{}: script \"{}\": there is no script \"{}\"", action.place.line, script.name, action.script));
      }
    } else if (action.kind != ActionKind::kWaitTime && action.target.kind != TargetKind::kEverything &&
               config.resolve(action.target).empty()) {
      errors.push_back(fmt::format("{}: script \"{}\": there is no {} \"{}\"", action.place.line, script.name,
                                   action.target.kind == TargetKind::kGroup ? "group" : "cmd", action.target.name));
    }
  }
  if (calls_itself(config, script)) {
    errors.push_back(
        fmt::format("{}: infinite loop: script \"{}\" eventually calls itself", script.place.line, script.name));
  }
}

}  // namespace

const Command* Config::find_command(std::string_view id) const {
  return find_by(commands, id, &Command::id);
}

const Script* Config::find_script(std::string_view name) const {
  return find_by(scripts, name, &Script::name);
}

std::vector<std::string> Config::resolve(const Target& target) const {
  std::vector<std::string> ids;
  for (const Command& command : commands) {
    if (target.kind == TargetKind::kEverything || (target.kind == TargetKind::kCommand && command.id == target.name) ||
        (target.kind == TargetKind::kGroup && is_inside(command.group, target.name))) {
      ids.push_back(command.id);
    }
  }
  return ids;
}

std::vector<std::vector<std::string>> Config::stages() const {
  std::vector<std::string> groups;
  std::vector<std::vector<std::string>> stages;
  for (const Command& command : commands) {
    auto it = std::find(groups.begin(), groups.end(), command.group);
    if (it == groups.end()) {
      it = groups.insert(it, command.group);
      stages.emplace_back();
    }
    stages[static_cast<std::size_t>(it - groups.begin())].push_back(command.id);
  }
  return stages;
}

std::vector<std::string> check_config(const Config& config) {
  std::vector<std::string> errors;
  std::map<std::string, int> lines;
  for (const Command& command : config.commands) {
    const auto wrong = [&, line = command.place.line](const std::string& what) {
      errors.push_back(fmt::format("{}: {}", line, what));
    };
    if (command.id.empty()) wrong(fmt::format("a cmd has no id (its exec is \"{}\")", command.exec));
    const auto [first, is_new] = lines.emplace(command.id, command.place.line);
    if (!command.id.empty() && !is_new) {
      wrong(fmt::format("there is already a cmd \"{}\", in line {}: ids are unique, over all deputies too", command.id,
                        first->second));
    }
    if (command.deputy.empty()) wrong(fmt::format("cmd \"{}\" names no deputy", command.id));
    const ExecLine line = parse_exec_line(command.exec, [](const std::string&) { return std::nullopt; });
    if (!line.error.empty()) wrong(fmt::format("cmd \"{}\": exec: {}", command.id, line.error));
  }
  return errors;
}

std::vector<std::string> check_script(const Config& config, const Script& script) {
  std::vector<std::string> errors;
  std::set<std::string> seen = {script.name};
  std::vector<const Script*> todo = {&script};
  while (!todo.empty()) {
    const Script& next = *todo.back();
    todo.pop_back();
    check_actions(config, next, errors);
    for (const Action& action : next.actions) {
      const Script* called = action.kind == ActionKind::kRunScript ? config.find_script(action.script) : nullptr;
      if (called != nullptr && seen.insert(called->name).second) todo.push_back(called);
    }
  }
  return errors;
}

Config load_config_file(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  if (!stream || !(text << stream.rdbuf())) {
    throw std::runtime_error(
        fmt::format("{}: cannot read it: {}", file, stream ? "it is empty" : std::strerror(errno)));
  }
  Config config = parse_config(text.str(), file);
  const std::vector<std::string> errors = check_config(config);
  if (!errors.empty()) throw std::runtime_error(join_errors(file, errors));
  return config;
}

std::string join_errors(const std::string& file, const std::vector<std::string>& errors) {
  return fmt::format("{}:{}", file, fmt::join(errors, "\n" + file + ":"));
}

}  // namespace curbstone::procman::config
