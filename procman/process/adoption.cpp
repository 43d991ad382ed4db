#include "procman/process/adoption.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <charconv>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string_view>

#include "common/time/clock.hpp"
#include "procman/config/exec_line.hpp"
#include "procman/process/process_table.hpp"

namespace curbstone::procman::process {

namespace {

constexpr int kPtsMajor = 136;  // of /dev/pts/N: Documentation/admin-guide/devices.txt

/// Fowler, Noll, Vo: 64 bits, FNV-1a. The same in each build, unlike std::hash.
void add_to_digest(std::uint64_t& digest, std::string_view text) {
  for (const char c : text) digest = (digest ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  digest *= 0x100000001b3U;  // as a byte 0: where the text ends
}

/// The number N of /dev/pts/N, from the device number of proc(5): minor in the bits 31..20 and 7..0, major in 15..8.
int pts_of(int device) {
  const auto bits = static_cast<unsigned>(device);
  if (((bits >> 8U) & 0xfffU) != kPtsMajor) return -1;
  return static_cast<int>((bits & 0xffU) | ((bits >> 12U) & 0xfff00U));
}

std::int64_t age_of(std::int64_t start_ticks) {
  timespec since_boot{};
  clock_gettime(CLOCK_BOOTTIME, &since_boot);
  return since_boot.tv_sec * 1'000'000 + since_boot.tv_nsec / 1000 - start_ticks * 1'000'000 / sysconf(_SC_CLK_TCK);
}

/// Of a mark, behind the pid.
std::string service_part() {
  const char* const address = std::getenv("NOTIFY_SOCKET");
  return fmt::format(":{}:", address == nullptr ? "" : address);
}

std::string control_group_of(const std::string& process) {
  std::ifstream stream("/proc/" + process + "/cgroup");
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

std::string to_text(const RunningCommand& command) {
  return fmt::format("{}.{}.{}.{:x}", command.pid, command.start_ticks, command.run_id, command.digest);
}

std::optional<RunningCommand> parse_running_command(const std::string& text) {
  RunningCommand command;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto take = [&](auto& value, int base, bool last) {
    const auto result = std::from_chars(at, end, value, base);
    if (result.ec != std::errc() || (last ? result.ptr != end : result.ptr == end || *result.ptr != '.')) return false;
    at = last ? end : result.ptr + 1;
    return true;
  };
  const bool whole = take(command.pid, 10, false) && take(command.start_ticks, 10, false) &&
                     take(command.run_id, 10, false) && take(command.digest, 16, true);
  return whole && command.pid > 0 ? std::optional(command) : std::nullopt;
}

std::uint64_t digest_of(const config::Command& command) {
  std::uint64_t digest = 0xcbf29ce484222325U;
  add_to_digest(digest, command.id);
  const config::ExecLine line = config::parse_exec_line(command.exec, config::from_environment);
  for (const std::string& word : line.argv) add_to_digest(digest, word);
  for (const auto& [name, value] : line.environment) {
    add_to_digest(digest, name);
    add_to_digest(digest, value);
  }
  for (const char* name : {"LCM_DEFAULT_URL", "CURBSTONE_CONFIG"}) {
    const char* value = std::getenv(name);
    add_to_digest(digest, value == nullptr ? "" : value);
  }
  return digest;
}

std::optional<AdoptedProcess> recognise(const RunningCommand& command, FileDescriptor& terminal) {
  AdoptedProcess adopted;
  // First the pidfd: what is then found under this pid is the process that it names.
  adopted.end = FileDescriptor(static_cast<int>(syscall(SYS_pidfd_open, command.pid, 0)));
  const auto found = read_process(command.pid);
  int pts = -1;
  if (!adopted.end || !found || found->zombie || ioctl(terminal.get(), TIOCGPTN, &pts) != 0) return std::nullopt;
  if (found->start_ticks != command.start_ticks || found->session != command.pid || pts_of(found->terminal) != pts)
    return std::nullopt;
  adopted.mark = read_mark(command.pid);
  if (adopted.mark.empty()) return std::nullopt;
  adopted.process.pid = command.pid;
  adopted.process.terminal = std::move(terminal);
  adopted.reaper = found->parent;
  adopted.started = steady_clock() - age_of(found->start_ticks);
  return adopted;
}

std::string new_mark_of(const std::string& id) {
  return std::to_string(getpid()) + service_part() + id;
}

std::vector<pid_t> find_leftovers() {
  const std::string service = service_part();
  const std::string own_group = control_group_of("self");
  std::vector<pid_t> leftovers;
  for (const ProcessInfo& info : read_process_table()) {
    if (info.zombie || info.pid == getpid() || control_group_of(std::to_string(info.pid)) != own_group) continue;
    const std::string mark = read_mark(info.pid);
    pid_t deputy = 0;
    const auto rest = std::from_chars(mark.data(), mark.data() + mark.size(), deputy);
    if (!std::string_view(rest.ptr).starts_with(service)) continue;
    if (deputy > 0 && deputy != getpid() && !read_process(deputy)) leftovers.push_back(info.pid);
  }
  return leftovers;
}

}  // namespace curbstone::procman::process
