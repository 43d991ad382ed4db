#include "procman/process/spawn.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <map>
#include <sstream>
#include <system_error>

namespace curbstone::procman::process {

namespace {

using Environment = std::map<std::string, std::string>;

[[noreturn]] void fail(int error, const std::string& what) {
  throw std::system_error(error, std::generic_category(), what);
}

Environment make_environment(const config::ExecLine& line, const std::string& mark) {
  Environment environment;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const std::size_t equals = text.find('=');
    if (equals != std::string::npos) environment[text.substr(0, equals)] = text.substr(equals + 1);
  }
  // These variables address the deputy, not its children.
  for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_PID", "WATCHDOG_USEC"}) environment.erase(name);
  environment[kMarkVariable] = mark;
  for (const auto& [name, value] : line.environment) environment[name] = value;
  return environment;
}

/// Finds a program as execvp() does, in the PATH of the new process.
std::string find_program(const std::string& name, const Environment& environment) {
  if (name.find('/') != std::string::npos) return name;
  const auto path = environment.find("PATH");
  std::istringstream folders(path == environment.end() ? "/usr/local/bin:/usr/bin:/bin" : path->second);
  int error = ENOENT;
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string candidate = (folder.empty() ? "." : folder) + "/" + name;
    struct stat info {};
    if (stat(candidate.c_str(), &info) != 0 || S_ISDIR(info.st_mode)) continue;
    if (access(candidate.c_str(), X_OK) == 0) return candidate;
    error = errno;
  }
  fail(error, name);
}

FileDescriptor open_terminal(std::string& slave) {
  FileDescriptor master(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  std::array<char, 64> name{};
  if (!master || grantpt(master.get()) != 0 || unlockpt(master.get()) != 0 ||
      ptsname_r(master.get(), name.data(), name.size()) != 0) {
    fail(errno, "pseudo-terminal");
  }
  slave = name.data();
  return master;
}

/// posix_spawn() instead of fork(): the deputy has a receiver thread, and the exec error is returned.
class SpawnSettings {
 public:
  explicit SpawnSettings(const std::string& terminal) {
    posix_spawn_file_actions_init(&actions);
    // The first terminal that a session leader opens becomes its controlling one.
    posix_spawn_file_actions_addopen(&actions, 0, terminal.c_str(), O_RDWR, 0);
    posix_spawn_file_actions_adddup2(&actions, 0, 1);
    posix_spawn_file_actions_adddup2(&actions, 0, 2);
    posix_spawn_file_actions_addclosefrom_np(&actions, 3);  // LCM's sockets are not close-on-exec
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigset_t all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  posix_spawn_file_actions_t actions{};
  posix_spawnattr_t attributes{};
};

/// The kernel spares the deputy when memory runs out (OOMScoreAdjust= of its unit). Its children must not inherit that:
/// otherwise the kernel could only end processes of others, and in the end the deputy.
void make_expendable(pid_t child) {
  const auto score_of = [](const std::string& process) { return "/proc/" + process + "/oom_score_adj"; };
  int own = 0;
  std::ifstream(score_of("self")) >> own;
  if (own < 0) std::ofstream(score_of(std::to_string(child))) << 0;
}

}  // namespace

SpawnedProcess spawn(const config::ExecLine& line, const std::string& mark) {
  const Environment environment = make_environment(line, mark);
  const std::string program = find_program(line.argv.at(0), environment);

  std::vector<std::string> entries;
  for (const auto& [name, value] : environment) entries.push_back(name + "=" + value);
  std::vector<std::string> words = line.argv;
  std::vector<char*> envp;
  std::vector<char*> argv;
  for (std::string& entry : entries) envp.push_back(entry.data());
  for (std::string& word : words) argv.push_back(word.data());
  envp.push_back(nullptr);
  argv.push_back(nullptr);

  SpawnedProcess process;
  std::string slave;
  process.terminal = open_terminal(slave);
  const SpawnSettings settings(slave);
  const int error =
      posix_spawn(&process.pid, program.c_str(), &settings.actions, &settings.attributes, argv.data(), envp.data());
  if (error != 0) fail(error, line.argv[0]);
  make_expendable(process.pid);
  return process;
}

}  // namespace curbstone::procman::process
