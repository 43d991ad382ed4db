#include "procman/deputy/deputy_app.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "common/bus/levels.hpp"
#include "common/time/clock.hpp"
#include "common/time/microseconds.hpp"
#include "common/time/silence_timer.hpp"
#include "procman/deputy/systemd_notify.hpp"
#include "procman/output/named_line.hpp"

namespace curbstone::procman::deputy {

namespace {

constexpr std::int64_t kShortLife = 1'000'000;  // us
constexpr int kCrashLoop = 5;  // consecutive short lives: reported once as a crash loop, then every 60th
constexpr std::size_t kLinesShown = 10;
constexpr std::size_t kLinesResent = 50;
constexpr std::int64_t kOldStatus = 5'000'000;  // us: an older status comes from a log that is being played

// By then the drivers have their ports open, and doctor can check what they receive.
constexpr std::int64_t kDoctorAfter = 10'000'000;   // us
constexpr std::int64_t kDoctorAgain = 600'000'000;  // us, while it has findings, so that fixed ones disappear

/// Programs are looked up beside the deputy first, and a vehicle's config where it is usually installed.
void prepare_environment() {
  std::error_code error;
  const auto own = std::filesystem::read_symlink("/proc/self/exe", error);
  const char* path = std::getenv("PATH");
  if (!error) setenv("PATH", (own.parent_path().string() + ":" + (path ? path : "/usr/bin:/bin")).c_str(), 1);
  setenv("CURBSTONE_CONFIG", "/etc/curbstone/ugv.yaml", 0);
}

std::string describe_status(int status) {
  if (WIFSIGNALED(status)) {
    return fmt::format("{}{}", strsignal(WTERMSIG(status)), WCOREDUMP(status) ? " (core dumped)" : "");
  }
  return fmt::format("exit status {}", WEXITSTATUS(status));
}

process::FileDescriptor take_signals(std::initializer_list<int> numbers) {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : numbers) sigaddset(&signals, number);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return process::FileDescriptor(signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC));
}

}  // namespace

DeputyApp::DeputyApp(DeputyAppOptions options)
    : options_(std::move(options)),
      console_(STDOUT_FILENO),
      errors_(STDERR_FILENO),
      keeper_(options_.log_dir, options_.keep),
      supervisor_(
          loop_, {.output =
                      [this](const std::string& id, std::string_view bytes) {
                        deputy_->output(id, bytes);
                        keeper_.add(id, bytes, [&](std::string_view line) { print_line(id, line); });
                      },
                  .started = [this](const process::CommandState& state) { on_started(state); },
                  .ended = [this](const process::CommandState& state, std::int64_t lived) { on_ended(state, lived); }}),
      other_signals_(take_signals({SIGHUP, SIGQUIT})) {
  prepare_environment();
  OwnConfig own = read_own_config(options_);
  config_ = std::move(own.config);
  for (const config::Command& command : config_.commands) supervisor_.set(command);
  bus_ = std::make_unique<LcmBus>(options_.lcm_url, LcmBus::WithoutRoute::kWait);
  deputy_ =
      std::make_unique<Deputy>(DeputyOptions{.id = options_.id,
                                             .allow_list = options_.allow_any ? std::nullopt : std::optional(config_),
                                             .allow_empty_orders = options_.allow_empty_orders},
                               supervisor_, *bus_);
  deputy_->on_sheriff_arrived = [this] { resend_last_lines(); };
  deputy_->connect(*bus_);
  for (const std::string& warning : own.warnings) log_line(warning);  // to sheriffs, too: deputy_ is there now
  reporter_.emplace("deputy:" + options_.id, "", Clocks{}, [this](const std::string& line) { errors_.print(line); });
  bus_->subscribe<service_status_t>("SERVICE_STATUS", [this](const service_status_t& status) { on_status(status); });
}

int DeputyApp::run() {
  loop_.watch(bus_->fd(), [this] { bus_->handle(std::chrono::milliseconds(0)); });
  loop_.watch(other_signals_.get(), [this] {
    signalfd_siginfo ignored{};
    (void)!read(other_signals_.get(), &ignored, sizeof ignored);
    loop_.stop();
  });
  loop_.every(std::chrono::milliseconds(10), [this] { tick(); });
  loop_.run();
  if (!deputy_->conflict().empty()) {
    fmt::print(stderr, "curbstone-deputy: {}; choose another --id, or stop that one\n", deputy_->conflict());
    return 2;
  }
  shut_down();
  return status_;
}

void DeputyApp::shut_down() {
  notify_systemd("STOPPING=1");
  deputy_->begin_shutdown();
  starting_.reset();
  script_.reset();
  doctor_.reset();
  if (supervisor_.any_running()) log_line("stopping");
  stopping_.emplace(supervisor_, config_.stages());
  while (!stopping_->step(steady_clock())) {
    loop_.run();  // until tick() has the end, or another signal arrives
    if (stopping_->step(steady_clock())) break;
    log_line("killing what is left");
    kills_ = true;
    supervisor_.kill_all();
  }
  for (const std::string& id : stopping_->abandoned()) log_line(fmt::format("{} does not even die when killed", id));
  deputy_->flush();
}

void DeputyApp::tick() {
  deputy_->tick();
  const std::int64_t now = steady_clock();
  if (!deputy_->conflict().empty()) loop_.stop();
  if (deputy_->active() && !begun_) begin();
  if (starting_ && starting_->step(now)) starting_.reset();
  replace_hung(now);
  run_doctor(now);
  if (script_ && !script_->done()) {
    script_->step(now);
    if (script_->done()) log_line(fmt::format("script \"{}\" is done", options_.script));
  }
  if (stopping_ ? stopping_->step(now) : end_at_ != 0 && now >= end_at_) loop_.stop();
  if (now >= second_due_) {
    second_due_ = now + 1'000'000;
    notify_systemd("WATCHDOG=1");
    if (begun_) publish_status(now);
  }
}

/// Identifies the command by the service's name: a command's id is its name on the bus.
void DeputyApp::on_status(const service_status_t& status) {
  if (status.host != host_name() || std::abs(wall_clock() - std::max<std::int64_t>(status.utime, 0)) > kOldStatus)
    return;
  if (status.service == "deputy:" + options_.id) heartbeats_.on_own_status(steady_clock());
  heartbeats_.on_status(status.service, status.fault.empty() && status.uptime >= SilenceTimer::kNamed, steady_clock());
}

void DeputyApp::replace_hung(std::int64_t now) {
  if (stopping_) return;
  for (const std::string& id : heartbeats_.take_timed_out(now)) {
    const process::CommandState* state = supervisor_.find(id);
    if (state == nullptr || state->pid == 0 || state->stopping) continue;
    const double seconds = state->command.heartbeat;
    log_line(fmt::format("{} has said nothing for {:.0f} s: it hangs and is replaced", id, seconds));
    alarms_.silent(id, seconds, now);
    supervisor_.replace(id);
  }
}

void DeputyApp::run_doctor(std::int64_t now) {
  if (doctor_done_) doctor_.reset();
  doctor_done_ = false;
  if (doctor_due_ == 0 || now < doctor_due_ || stopping_ || doctor_) return;
  doctor_due_ = 0;
  try {
    doctor_.emplace(loop_, options_.config_file, options_.lcm_url,
                    [this](DoctorResult result) { on_doctor(std::move(result)); });
  } catch (const std::system_error& error) {
    on_doctor({std::nullopt, error.what()});
  }
}

void DeputyApp::on_doctor(DoctorResult result) {
  doctor_done_ = true;
  if (!result.findings) return log_line("doctor: `curbstone doctor` could not be run: " + result.why_not);
  for (const std::string& finding : *result.findings) {  // printed as a fault of the status; this is for sheriffs
    if (std::find(findings_.begin(), findings_.end(), finding) == findings_.end())
      deputy_->output("", "doctor: " + finding + "\n");
  }
  if (result.findings->empty()) log_line("doctor: all is well");
  findings_ = std::move(*result.findings);
  if (!findings_.empty()) doctor_due_ = steady_clock() + kDoctorAgain;
}

void DeputyApp::publish_status(std::int64_t now) {
  NodeReport report;
  report.counters = deputy_->counters();
  std::int64_t starts = 0, running = 0;
  for (const process::CommandState* state : supervisor_.commands()) {
    starts += state->starts;
    running += state->pid != 0 ? 1 : 0;
  }
  report.counters.set("commands.starts", starts);
  set_level(report.counters, "commands.running", running);
  report.counters.set("output.unwritten", keeper_.write_failures());
  if (const auto dropped = console_.dropped() + errors_.dropped(); dropped > 0)
    report.counters.set("output.unprinted", dropped);
  report.faults = alarms_.faults(supervisor_.commands(), now);
  if (const auto fault = bus_->fault())
    report.faults.push_back(*fault);
  else if (heartbeats_.is_bus_silent(now))
    report.faults.emplace_back("the bus carries nothing: curbstone doctor finds the reason");
  for (const auto& [id, seconds] : heartbeats_.overdue(now)) {
    if (const process::CommandState* state = supervisor_.find(id); state == nullptr || state->stopping) continue;
    report.faults.push_back(
        fmt::format("{} has said nothing for {:.0f} s: it is stopped, hangs, or gets no CPU", id, seconds));
  }
  if (const auto fault = keeper_.fault()) report.faults.push_back(*fault);
  for (const std::string& finding : findings_) report.faults.push_back("doctor: " + finding);
  reporter_->publish(*bus_, bus_->counters(), report);
}

bool DeputyApp::is_up(const std::string& id) const {
  const process::CommandState* state = supervisor_.find(id);
  return state == nullptr || state->pid == 0 || heartbeats_.alive(id);
}

/// Whether a script's wait is over. "running" means, as in procman, that the deputy has done what it could: a script
/// does not hang on a program that cannot start. A watched command must also have sent a status: before that it
/// receives nothing either.
bool DeputyApp::has_reached(const std::string& id, config::WaitStatus wanted) const {
  const process::CommandState* state = supervisor_.find(id);
  if (state == nullptr || (state->pid == 0 && state->respawn_at == 0)) return true;
  if (wanted == config::WaitStatus::kReady) return state->pid != 0 && heartbeats_.ready(id);
  if (state->pid == 0) return true;
  if (wanted != config::WaitStatus::kRunning || state->stopping) return false;
  return heartbeats_.alive(id) || steady_clock() - state->started > StartSequence::kPatience;
}

void DeputyApp::begin() {
  begun_ = true;
  heartbeats_.on_own_status(steady_clock());  // a bus that carries nothing from the start is silent, not the commands
  if (options_.doctor) doctor_due_ = steady_clock() + kDoctorAfter;
  notify_systemd("READY=1");
  log_line(fmt::format("deputy \"{}\" on {}, {} commands", options_.id, bus_->url(), config_.commands.size()));
  for (const config::Command& command : config_.commands) {
    const config::ExecLine line = config::parse_exec_line(command.exec, config::from_environment);
    for (const std::string& name : line.unknown_variables) {
      log_line(fmt::format("{}: ${} is not set and stays as written", command.id, name));
    }
  }
  adoptions_.adopt(config_, supervisor_,
                   {[this](const std::string& id, std::int32_t run_id) { deputy_->adopted(id, run_id); },
                    [this](const std::string& text) { log_line(text); }});
  if (options_.start_all) {
    starting_.emplace(config_.stages(), StartSequence::Callbacks{[this](const std::string& id) { deputy_->start(id); },
                                                                 [this](const std::string& id) { return is_up(id); }});
  }
  if (!options_.script.empty()) {
    script_.emplace(config_, options_.script,
                    ScriptRunner::Callbacks{
                        [this](const std::string& id) { deputy_->start(id); },
                        [this](const std::string& id) { supervisor_.stop(id); },
                        [this](const std::string& id) { supervisor_.restart(id); },
                        [this](const std::string& id, config::WaitStatus wanted) { return has_reached(id, wanted); }});
  }
}

void DeputyApp::on_started(const process::CommandState& state) {
  deputy_->changed();
  heartbeats_.begin(state.command.id, state.command.heartbeat, steady_clock());
  const std::string& id = state.command.id;
  adoptions_.started(state, deputy_->run_id(id), supervisor_.terminal(id));
  const std::string what =
      fmt::format("{}, pid {}", state.adopted ? "runs on, started by an earlier deputy" : "started", state.pid);
  keeper_.note(id, "-- " + what);
  if (short_runs_[id] < kCrashLoop) log_line(fmt::format("{} {}", id, what));
}

void DeputyApp::on_ended(const process::CommandState& state, std::int64_t lived) {
  deputy_->changed();
  const std::string& id = state.command.id;
  keeper_.end(id, [&](std::string_view line) { print_line(id, line); });
  if (WIFSIGNALED(state.exit_status)) {  // in procman's words, for sheriffs
    deputy_->output(id, fmt::format("{}\n{}", strsignal(WTERMSIG(state.exit_status)),
                                    WCOREDUMP(state.exit_status) ? "Core dumped.\n" : ""));
  }
  const std::string status = state.adopted ? "unknown exit status" : describe_status(state.exit_status);
  const std::string how = fmt::format("{} after {:.1f} s", status, static_cast<double>(lived) * 1e-6);
  keeper_.note(id, "-- ended: " + how);
  heartbeats_.end(id);
  adoptions_.ended(id);
  alarms_.ended(state, how, steady_clock());
  int& short_runs = short_runs_[id];
  short_runs = lived < kShortLife && state.respawn_at != 0 ? short_runs + 1 : 0;
  if (short_runs < kCrashLoop) {
    std::string what = fmt::format("{} ended: {}", id, how);
    if (state.hung) what += "; it hung and is replaced";
    if (state.killed && !state.hung && !kills_)
      what += fmt::format("; it was killed: it did not stop within {} s", state.command.stop_time_allowed);
    if (state.refused) what += "; wrong configuration or options: it is not started again until ordered";
    log_line(what);
  } else if (short_runs == kCrashLoop || short_runs % 60 == 0) {
    log_line(fmt::format("{} keeps dying: {} times in a row within a second ({})", id, short_runs, how));
  }
  if (!state.stopping && state.exit_status != 0 && short_runs <= kCrashLoop) show_last_lines(id);
  if (id == options_.exit_when && !stopping_ && end_at_ == 0) {
    status_ = state.exit_status == 0 ? 0 : 1;
    end_at_ = steady_clock() + microseconds(options_.settle);
  }
}

void DeputyApp::log_line(const std::string& text) {
  console_.print("deputy: " + text);
  deputy_->output("", text + "\n");
}

void DeputyApp::print_line(const std::string& id, std::string_view line) {
  if (!options_.quiet) console_.print(output::named_line(id, line));
}

/// For a command that failed while its output was not printed.
void DeputyApp::show_last_lines(const std::string& id) {
  if (!options_.quiet) return;
  for (const std::string& line : keeper_.last_lines(id, kLinesShown))
    console_.print("  " + output::named_line(id, line));
}

/// Resends the last output for a sheriff that arrives late.
void DeputyApp::resend_last_lines() {
  for (const process::CommandState* state : supervisor_.commands()) {
    const std::string& id = state->command.id;
    for (const std::string& line : keeper_.last_lines(id, kLinesResent)) deputy_->output(id, line + "\r\n");
  }
}

}  // namespace curbstone::procman::deputy
