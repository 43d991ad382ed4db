#include "tools/bench/faults/stack_drive.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <curbstone/map_pose_t.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/shell/fault_lines.hpp"
#include "common/time/clock.hpp"
#include "tools/command/program_beside.hpp"

namespace curbstone::bench::faults {

namespace {

constexpr double kPatience = 120;          // s, time-out for what takes seconds on an idle machine
constexpr double kRendering = 900;         // s, time-out for rendering a minute of packets on a busy machine
constexpr double kSettle = 8;              // s after the drive in which lost messages are requested again
constexpr double kBeforeEnd = 0.3;         // s before the end of the drive at which it is no longer watched
constexpr std::int64_t kSilent = 3000000;  // us: statuses come each second

double seconds_since(std::int64_t steady) {
  return static_cast<double>(steady_clock() - steady) * 1e-6;
}

}  // namespace

StackDrive::StackDrive(const StackOptions& options) : options_(options) {
  if (bus_.wait_until([&] { return bus_.infos > 0; }, 1.5))
    throw std::runtime_error("a deputy is on this bus already: this needs one of its own, see scripts/isolated");
  if (options_.disk_mb > 0) disk_ = std::make_unique<SmallDisk>(options_.folder, options_.disk_mb);
  std::filesystem::create_directories(options_.folder + "/dev");
  const std::string path = command::own_folder().string() + ":" + std::getenv("PATH");
  setenv("PATH", path.c_str(), 1);
  for (const char* unused : {"DEMO_SOURCE", "DEMO_IMU", "DEMO_ENCODER", "DEMO_LIDAR"}) setenv(unused, "", 1);
  setenv("DEMO_OUT", options_.folder.c_str(), 1);
  setenv("CURBSTONE_CONFIG", options_.config.c_str(), 1);

  bus_.bus.subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t&) {
    if (begin_ == 0) begin_ = steady_clock();
  });
  simulator_ = std::make_unique<programs::BackgroundProgram>(
      fmt::format("curbstone simulate --live --town --seed 1 --seconds {} {} --config '{}' --head-start 5 --imu-link "
                  "'{}/dev/imu' "
                  "--can-link '{}/dev/can' --spool '{}' --truth '{}/truth'",
                  options_.seconds, options_.simulate, options_.config, options_.folder, options_.folder,
                  options_.spool, options_.folder),
      options_.folder + "/simulate.out");
  start_deputy();
  if (!bus_.wait_until([&] { return begin_ != 0 || over(); }, kRendering) || over())
    throw std::runtime_error(fmt::format("the drive does not begin: {}{}", simulator_->output(), deputy_->output()));
  for (const auto& status : bus_.deputy.cmds) {
    if (status.pid > 0) commands_.push_back(status.cmd.command_id);
  }
}

StackDrive::~StackDrive() {
  for (const pid_t loop : loops_) {
    kill(loop, SIGKILL);
    waitpid(loop, nullptr, 0);
  }
}

void StackDrive::start_deputy() {
  deputy_ = manager_.start(fmt::format("curbstone-deputy --config '{}' --script stack --quiet --log-dir '{}/logs'",
                                       options_.procman_config, options_.folder),
                           options_.folder + "/deputy.out");
}

bool StackDrive::over() {
  return !simulator_->running();
}

double StackDrive::now() const {
  return begin_ == 0 ? 0 : seconds_since(begin_);
}

void StackDrive::listen(double seconds) {
  bus_.wait_until(
      [&] {
        look();
        return over();
      },
      seconds);
}

void StackDrive::go_on_until(double at) {
  listen(std::max(0.0, at - now()));
}

bool StackDrive::is_well(const std::string& command) const {
  const service_status_t* status = bus_.status(command);
  return status != nullptr && status->pid == bus_.pid(command) && !killed_.contains(status->pid) &&
         status->fault.empty() && wall_clock() - status->utime < kSilent;
}

void StackDrive::look() {
  for (const std::string& command : commands_) {
    const service_status_t* status = bus_.status(command);
    if (done_ && status != nullptr && wall_clock() - status->utime > kSilent) silent_.insert(command);
  }
  well_ = std::all_of(commands_.begin(), commands_.end(), [&](const auto& command) { return is_well(command); });
  if (!well_) last_bad_ = steady_clock();
}

void StackDrive::deed_done() {
  if (!done_) bus_.all_faults.clear();  // those of the start-up
  done_ = true;
  fault_is_over();
}

void StackDrive::kill_without_notice(const std::string& command) {
  const int victim = bus_.pid(command);
  if (victim <= 0) return;
  killed_.insert(victim);
  kill(victim, SIGKILL);
}

void StackDrive::kill_command(const std::string& command) {
  if (command == "deputy") {
    deputy_->send_signal(SIGKILL);
    deputy_->wait(kPatience);
    start_deputy();
  } else {
    kill_without_notice(command);
  }
  deed_done();
}

void StackDrive::kill_commands(const std::string& one, const std::string& other) {
  kill_without_notice(one);
  kill_without_notice(other);
  deed_done();
}

void StackDrive::fill_disk(double seconds) {
  if (!disk_) throw std::runtime_error("the disk of the machine is not filled");
  disk_->fill();
  deed_done();
  listen(seconds);
  disk_->free();
  fault_is_over();
}

void StackDrive::take_interface_down(double seconds) {
  const auto run = [](const char* line) {
    if (std::system(line) != 0) throw std::runtime_error(fmt::format("failed: {}", line));
  };
  run("ip link set lo down");
  deed_done();
  listen(seconds);
  run("ip link set lo up && ip link set lo multicast on && ip route replace 239.255.76.67/32 dev lo");
  fault_is_over();
}

void StackDrive::freeze(const std::string& command, double seconds) {
  const int victim = bus_.pid(command);
  if (victim <= 0) throw std::runtime_error(command + " does not run");
  kill(victim, SIGSTOP);
  deed_done();
  listen(seconds);
  kill(victim, SIGCONT);
  fault_is_over();
}

void StackDrive::hang(const std::string& command) {
  const int victim = bus_.pid(command);
  if (victim <= 0) throw std::runtime_error(command + " does not run");
  killed_.insert(victim);
  kill(victim, SIGSTOP);
  deed_done();
}

void StackDrive::lose_power() {
  deputy_->send_signal(SIGKILL);
  for (const std::string& command : commands_) kill_without_notice(command);
  deputy_->wait(kPatience);
  manager_.close_all();
  start_deputy();
  deed_done();
}

void StackDrive::keep_cpu_busy(int loops, double seconds) {
  for (int i = 0; i < loops; ++i) {
    const pid_t child = fork();
    if (child == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      volatile unsigned work = 0;
      for (;;) work = ~work;
    }
    loops_.push_back(child);
  }
  deed_done();
  listen(seconds);
  for (const pid_t loop : loops_) {
    kill(loop, SIGKILL);
    waitpid(loop, nullptr, 0);
  }
  loops_.clear();
  fault_is_over();
}

void StackDrive::fault_is_over() {
  if (!done_) bus_.all_faults.clear();
  done_ = true;
  over_ = last_bad_ = steady_clock();
}

void StackDrive::finish() {
  go_on_until(options_.seconds - kBeforeEnd);
  const auto said = bus_.all_faults;  // taken now: missing devices after the vehicle's arrival are no fault
  if (!bus_.wait_until([&] { return over(); }, options_.seconds + kPatience))
    throw std::runtime_error("the emulated vehicle does not arrive: " + simulator_->output());
  bus_.wait_until([] { return false; }, kSettle);
  bus_.all_faults = said;
  deputy_->send_signal(SIGINT);
  bus_.wait_until([&] { return !deputy_->running(); }, kPatience);
  bus_.all_faults = said;
  clean_ = deputy_->wait(0) == 0 && deputy_->output().find("it was killed") == std::string::npos;
}

std::optional<double> StackDrive::back_within() const {
  if (!well_) return std::nullopt;
  return static_cast<double>(last_bad_ - over_) * 1e-6;
}

std::vector<std::string> StackDrive::faults_said() const {
  std::set<std::string> said;
  for (const auto& [service, faults] : bus_.all_faults) {
    for (const std::string& fault : faults) said.insert(fmt::format("{}: {}", service, without_numbers(fault)));
  }
  for (const std::string& command : silent_) said.insert(command + ": (no status for 3 s)");
  return {said.begin(), said.end()};
}

double StackDrive::emulator_late() const {
  const auto truth = nlohmann::json::parse(std::ifstream(options_.folder + "/truth/truth.json"));
  return truth.at("latest_packet_s").get<double>();
}

}  // namespace curbstone::bench::faults
