#include "procman/process/process_table.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "procman/process/spawn.hpp"

namespace curbstone::procman::process {

namespace {

/// The readable text. If a process ends between the opening and the reading of its file, the reading fails (ESRCH);
/// read() reports that, and an iterator would throw.
std::string read_text(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string text;
  std::array<char, 4096> part{};
  do {
    stream.read(part.data(), part.size());
    text.append(part.data(), static_cast<std::size_t>(stream.gcount()));
  } while (stream);
  return text;
}

}  // namespace

std::optional<ProcessInfo> parse_process_stat(const std::string& text) {
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return std::nullopt;
  ProcessInfo info;
  std::istringstream head(text);
  std::istringstream rest(text.substr(name_end + 1));
  std::int64_t skipped = 0;
  char state = '?';
  std::int64_t user = 0;
  std::int64_t system = 0;
  std::int64_t pages = 0;
  head >> info.pid;
  rest >> state >> info.parent >> skipped >> info.session >> info.terminal;  // fields 3..7 of proc(5)
  for (int field = 8; field <= 13; ++field) rest >> skipped;
  rest >> user >> system;  // 14, 15
  for (int field = 16; field <= 21; ++field) rest >> skipped;
  rest >> info.start_ticks >> info.memory_virtual >> pages;  // 22..24
  if (!head || !rest) return std::nullopt;
  info.zombie = state == 'Z' || state == 'X';
  info.cpu_ticks = user + system;
  info.memory_resident = pages * sysconf(_SC_PAGESIZE);
  return info;
}

std::optional<ProcessInfo> read_process(pid_t pid) {
  return parse_process_stat(read_text("/proc/" + std::to_string(pid) + "/stat"));
}

std::vector<ProcessInfo> read_process_table() {
  std::vector<ProcessInfo> table;
  std::error_code error;
  for (std::filesystem::directory_iterator entry("/proc", error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    pid_t pid = 0;
    const auto result = std::from_chars(name.data(), name.data() + name.size(), pid);
    if (result.ec != std::errc() || result.ptr != name.data() + name.size()) continue;
    if (const auto info = read_process(pid)) table.push_back(*info);
  }
  return table;
}

std::string read_mark(pid_t pid) {
  std::string name(1, '\0');  // piece by piece: of one long sum g++ 12 warns falsely where it sanitizes
  name += kMarkVariable;
  name += '=';
  const std::string environment = '\0' + read_text("/proc/" + std::to_string(pid) + "/environ");
  const std::size_t at = environment.find(name);
  return at == std::string::npos ? "" : environment.c_str() + at + name.size();
}

std::vector<pid_t> find_family(const std::vector<ProcessInfo>& table, pid_t leader, const std::string& mark,
                               pid_t reaper) {
  const pid_t self = getpid();
  std::set<pid_t> members;
  for (const ProcessInfo& info : table) {
    const bool orphan = info.parent == self || info.parent == reaper;
    const bool adopted = orphan && info.pid != leader && read_mark(info.pid) == mark;
    if (info.pid == leader || info.session == leader || adopted) members.insert(info.pid);
  }
  for (bool grown = true; grown;) {  // repeated, because a child may be listed before its parent
    grown = false;
    for (const ProcessInfo& info : table) {
      if (members.contains(info.parent) && members.insert(info.pid).second) grown = true;
    }
  }
  std::vector<pid_t> living;
  for (const ProcessInfo& info : table) {
    if (members.contains(info.pid) && !info.zombie) living.push_back(info.pid);
  }
  return living;
}

MachineInfo read_machine() {
  MachineInfo machine;
  std::istringstream cpu(read_text("/proc/stat"));
  std::string label;
  std::int64_t user = 0;
  std::int64_t nice = 0;
  std::int64_t system = 0;
  cpu >> label >> user >> nice >> system >> machine.cpu_ticks_idle;
  machine.cpu_ticks_total = user + nice + system + machine.cpu_ticks_idle;
  std::istringstream memory(read_text("/proc/meminfo"));
  for (std::string line; std::getline(memory, line);) {
    std::istringstream words(line);
    std::int64_t kilobytes = 0;
    words >> label >> kilobytes;
    if (label == "MemTotal:") machine.memory_total = kilobytes * 1024;
    if (label == "MemFree:") machine.memory_free = kilobytes * 1024;
    if (label == "SwapTotal:") machine.swap_total = kilobytes * 1024;
    if (label == "SwapFree:") machine.swap_free = kilobytes * 1024;
  }
  return machine;
}

}  // namespace curbstone::procman::process
