#include "procman/deputy/doctor_run.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "common/json/json_text.hpp"

namespace curbstone::procman::deputy {

namespace {

constexpr std::size_t kMaxText = 1 << 20;

constexpr std::size_t kMaxErrors = 4096;  // bytes

/// Starts it with an empty signal mask: the deputy blocks the signals that it takes by signalfd(2). Returns 0 or errno.
int start_program(const std::vector<std::string>& words, int output, int errors, pid_t& child) {
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));  // POSIX declares argv so
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  if (errors >= 0) posix_spawn_file_actions_adddup2(&actions, errors, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  const int error = posix_spawnp(&child, argv[0], &actions, &attributes, argv.data(), environ);
  if (error != 0) child = 0;
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

}  // namespace

std::optional<std::vector<std::string>> doctor_findings(const std::string& json) {
  std::vector<std::string> findings;
  try {
    const nlohmann::json report = parse_json(json);
    for (const auto& check : report.at("checks")) {
      if (check.at("kind") != "finding") continue;
      findings.push_back(fmt::format("{}: {}; fix: {}", check.at("check").get<std::string>(),
                                     check.at("what").get<std::string>(), check.at("fix").get<std::string>()));
    }
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
  return findings;
}

DoctorRun::DoctorRun(EventLoop& loop, const std::string& procman_config, const std::string& lcm_url, Done done)
    : loop_(loop), done_(std::move(done)) {
  std::array<int, 2> ends{-1, -1};
  if (pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0) throw std::system_error(errno, std::generic_category(), "pipe2");
  output_ = process::FileDescriptor(ends[0]);
  const process::FileDescriptor input(ends[1]);
  std::vector<std::string> words = {"curbstone", "doctor", "--json", "--procman", procman_config};
  if (const char* config = getenv("CURBSTONE_CONFIG")) words.insert(words.end(), {"--config", config});
  if (!lcm_url.empty()) words.insert(words.end(), {"--lcm-url", lcm_url});
  errors_ = process::FileDescriptor(memfd_create("doctor", MFD_CLOEXEC));
  if (const int error = start_program(words, input.get(), errors_.get(), pid_); error != 0)
    start_error_ = std::generic_category().message(error);
  loop_.watch(output_.get(), [this] { read_on(); });  // at its end at once, if nothing was started
}

DoctorRun::~DoctorRun() {
  loop_.unwatch(output_.get());
  if (pid_ != 0) kill(pid_, SIGKILL);  // reaped by the owner of the child signal
}

void DoctorRun::read_on() {
  std::array<char, 4096> bytes{};
  const ssize_t size = read(output_.get(), bytes.data(), bytes.size());
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (size > 0 && text_.size() < kMaxText) {
    text_.append(bytes.data(), static_cast<std::size_t>(size));
    return;
  }
  loop_.unwatch(output_.get());
  pid_ = 0;
  const Done done = done_;  // it may destroy this object
  DoctorResult result{doctor_findings(text_), {}};
  if (!result.findings) result.why_not = why_without_report();
  done(std::move(result));
}

/// The last line of what it said, which is the error.
std::string DoctorRun::why_without_report() const {
  if (!start_error_.empty()) return "curbstone: " + start_error_;
  std::string said(kMaxErrors, '\0');
  const off_t end = lseek(errors_.get(), 0, SEEK_END);
  const off_t begin = std::max<off_t>(end - static_cast<off_t>(kMaxErrors), 0);
  const ssize_t size = pread(errors_.get(), said.data(), said.size(), begin);
  said.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  while (!said.empty() && said.back() == '\n') said.pop_back();
  if (const auto line = said.rfind('\n'); line != std::string::npos) said.erase(0, line + 1);
  if (!said.empty()) return said;
  return text_.empty() ? "it ended without a report" : "what it printed is no report";
}

}  // namespace curbstone::procman::deputy
