#include "procman/sheriff/sheriff_app.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/output_t.hpp>
#include <set>

#include "common/shell/status_reporter.hpp"
#include "common/terminal/screen.hpp"
#include "common/time/clock.hpp"
#include "procman/deputy/script_runner.hpp"
#include "procman/output/line_splitter.hpp"
#include "procman/output/named_line.hpp"
#include "procman/sheriff/status_table.hpp"

namespace curbstone::procman::sheriff {

namespace {

constexpr std::int64_t kListen = 1'500'000;     // us: deputies and sheriffs send once a second
constexpr std::int64_t kClaimPeriod = 200'000;  // us
constexpr std::int64_t kRefresh = 500'000;      // us
constexpr std::chrono::milliseconds kTurn(50);
constexpr int kFailedStatus = 1;
constexpr int kNoDeputyStatus = 3;
constexpr int kConflictStatus = 4;

/// The name in the format of procman's sheriffs.
std::string sheriff_name(std::int64_t begun) {
  return fmt::format("{}:{}:{}", host_name(), getpid(), begun);
}

Sheriff new_sheriff() {
  const std::int64_t begun = wall_clock();
  return Sheriff(sheriff_name(begun), begun);
}

}  // namespace

SheriffApp::SheriffApp(SheriffAppOptions options)
    : options_(std::move(options)), bus_(options_.lcm_url), sheriff_(new_sheriff()) {
  bus_.subscribe<procman_lcm::deputy_info_t>("PM_INFO", [this](const auto& info) {
    sheriff_.on(info, wall_clock());
    if (!ordering_ || !sheriff_.other().empty()) return;
    if (const auto orders = sheriff_.orders(info.deputy_id, wall_clock())) bus_.publish("PM_ORDERS", *orders);
  });
  bus_.subscribe<procman_lcm::orders_t>("PM_ORDERS", [this](const auto& orders) { sheriff_.on(orders, wall_clock()); });
  bus_.subscribe<service_status_t>("SERVICE_STATUS", [this](const auto& status) { sheriff_.on(status, wall_clock()); });
}

int SheriffApp::run() {
  if (options_.action == Action::kTail) return tail();
  listen();
  if (options_.action == Action::kWatch) return watch();
  if (gives_orders() && !sheriff_.other().empty()) return say_conflict();
  if (sheriff_.commands().empty()) {
    fmt::print(stderr, "curbstone-sheriff: no deputy with commands answers on {}\n", bus_.url());
    return kNoDeputyStatus;
  }
  if (options_.action == Action::kStatus) {
    Screen(STDOUT_FILENO).show(picture());
    return 0;
  }
  return options_.action == Action::kRun ? run_script() : order();
}

void SheriffApp::listen() {
  if (!options_.observe)
    bus_.publish("PM_DISCOVER", procman_lcm::discovery_t{wall_clock(), sheriff_name(wall_clock()), 0});
  const std::int64_t until = steady_clock() + kListen;
  std::int64_t claim_due = 0;
  while (steady_clock() < until && (!gives_orders() || sheriff_.other().empty())) {
    if (gives_orders() && steady_clock() >= claim_due) {
      bus_.publish("PM_ORDERS", sheriff_.claim());
      claim_due = steady_clock() + kClaimPeriod;
    }
    handle();
  }
}

bool SheriffApp::gives_orders() const {
  const Action action = options_.action;
  return action == Action::kStart || action == Action::kStop || action == Action::kRestart || action == Action::kRun;
}

void SheriffApp::handle() {
  bus_.handle(kTurn);
}

int SheriffApp::say_conflict() const {
  fmt::print(stderr, "curbstone-sheriff: another sheriff gives orders: {}; end that one first\n",
             printable(sheriff_.other()));
  return kConflictStatus;
}

std::vector<std::string> SheriffApp::picture(const TextStyle& style) const {
  const std::int64_t now = wall_clock();
  std::vector<std::string> lines = status_table(sheriff_.commands(), now, style);
  for (const std::string& note : sheriff_.notes(now))
    lines.push_back(styled_line(printable(note), Colour::kWarning, style));
  if (!sheriff_.other().empty())
    lines.insert(lines.begin(), styled_line("orders come from " + sheriff_.other(), Colour::kWarning, style));
  return lines;
}

int SheriffApp::watch() {
  const Screen screen(STDOUT_FILENO);
  while (screen.show(picture(screen.style())) && screen.is_terminal()) {
    const std::int64_t until = steady_clock() + kRefresh;
    while (steady_clock() < until) handle();
  }
  return 0;
}

std::vector<std::string> SheriffApp::named() const {
  std::set<std::string> ids;
  for (const std::string& name : options_.names) {
    const auto found = sheriff_.resolve(name);
    if (found.empty()) throw UnknownName(fmt::format("no deputy has a command or group \"{}\"", name));
    ids.insert(found.begin(), found.end());
  }
  return {ids.begin(), ids.end()};
}

int SheriffApp::order() {
  const auto ids = named();
  for (const std::string& id : ids) {
    if (options_.action == Action::kStart) sheriff_.start(id);
    if (options_.action == Action::kStop) sheriff_.stop(id);
    if (options_.action == Action::kRestart) sheriff_.restart(id);
  }
  ordering_ = true;
  const std::int64_t until = deadline();
  const auto is = [&](Progress progress) {
    return [&, progress](const std::string& id) { return sheriff_.progress(id) == progress; };
  };
  while (steady_clock() < until && std::any_of(ids.begin(), ids.end(), is(Progress::kUnderWay))) {
    handle();
    if (!sheriff_.other().empty()) return say_conflict();
  }
  int result = 0;
  for (const std::string& id : ids) {
    const auto known = sheriff_.commands().find(id);
    const bool done = is(Progress::kDone)(id);
    const std::string state = known == sheriff_.commands().end() ? "gone" : describe(known->second.status);
    fmt::print("{}: {}{}\n", printable(id), state,
               is(Progress::kUnderWay)(id) ? fmt::format(", not done within {} s", options_.wait) : "");
    if (!done) result = kFailedStatus;
  }
  return result;
}

/// The configuration with the script. Throws UnknownName if a deputy cannot run the script as it is written there.
config::Config SheriffApp::script_config() const {
  config::Config config = config::load_config_file(options_.config_file);
  const std::string& script = options_.names.front();
  if (config.find_script(script) == nullptr)
    throw UnknownName(fmt::format("{} has no script \"{}\"", options_.config_file, script));
  const std::vector<std::string> errors = config::check_script(config, *config.find_script(script));
  if (!errors.empty()) throw UnknownName(config::join_errors(options_.config_file, errors));
  for (const config::Command& command : config.commands) {
    if (!sheriff_.commands().contains(command.id))
      throw UnknownName(fmt::format("no deputy has the command \"{}\" of {}", command.id, options_.config_file));
  }
  return config;
}

bool SheriffApp::is_under_way(const std::string& id) const {
  return sheriff_.progress(id) == Progress::kUnderWay;
}

/// Whether a script need not wait for the command any longer. `asked`: this sheriff has ordered its present state.
bool SheriffApp::fulfils(const std::string& id, config::WaitStatus wait, bool asked) const {
  const auto known = sheriff_.commands().find(id);
  if (known == sheriff_.commands().end()) return false;
  if (asked && is_under_way(id)) return false;
  const bool runs = known->second.status.pid != 0;
  if (wait == config::WaitStatus::kReady) return !runs || known->second.ready();
  return asked || runs == (wait == config::WaitStatus::kRunning);
}

std::int64_t SheriffApp::deadline() const {
  return steady_clock() + static_cast<std::int64_t>(options_.wait * 1e6);
}

int SheriffApp::run_script() {
  const config::Config config = script_config();
  const std::string& script = options_.names.front();
  std::set<std::string> touched;
  const auto touch = [&](void (Sheriff::*act)(const std::string&)) {
    return [&, act](const std::string& id) {
      touched.insert(id);
      (sheriff_.*act)(id);
    };
  };
  deputy::ScriptRunner runner(config, script,
                              {.start = touch(&Sheriff::start),
                               .stop = touch(&Sheriff::stop),
                               .restart = touch(&Sheriff::restart),
                               .satisfied = [&](const std::string& id, config::WaitStatus wait) {
                                 return fulfils(id, wait, touched.contains(id));
                               }});
  ordering_ = true;
  const std::int64_t until = deadline();
  const auto under_way = [&] {
    return !runner.done() ||
           std::any_of(touched.begin(), touched.end(), [&](const std::string& id) { return is_under_way(id); });
  };
  do {
    runner.step(steady_clock());
    handle();
    if (!sheriff_.other().empty()) return say_conflict();
  } while (under_way() && steady_clock() < until);
  fmt::print("{}\n", fmt::join(picture(), "\n"));
  if (under_way()) fmt::print(stderr, "curbstone-sheriff: {} not done within {} s\n", script, options_.wait);
  const bool good = runner.done() && std::all_of(touched.begin(), touched.end(), [&](const std::string& id) {
                      return sheriff_.progress(id) == Progress::kDone;
                    });
  return good ? 0 : kFailedStatus;
}

int SheriffApp::tail() {
  const auto wanted = [this](const std::string& id) {
    if (options_.names.empty()) return true;
    return std::any_of(options_.names.begin(), options_.names.end(), [&](const std::string& name) {
      const auto ids = sheriff_.resolve(name);
      return name == id || std::find(ids.begin(), ids.end(), id) != ids.end();
    });
  };
  bus_.subscribe<procman_lcm::output_t>("PM_OUTPUT", [&](const procman_lcm::output_t& message) {
    for (std::size_t i = 0; i < message.text.size(); ++i) {
      const std::string& id = message.command_ids[i];
      if (!wanted(id)) continue;
      const auto print = [&id](std::string_view line) { fmt::print("{}\n", printable(output::named_line(id, line))); };
      output::LineSplitter lines;
      lines.feed(message.text[i], print);
      lines.flush(print);
    }
    std::fflush(stdout);
  });
  listen();
  while (std::ferror(stdout) == 0) handle();
  return kFailedStatus;  // why is said at the end of the process
}

}  // namespace curbstone::procman::sheriff
