#include "tools/doctor/facts/host_facts.hpp"

#include <sched.h>
#include <sys/timex.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace curbstone::doctor::facts {

namespace {

std::string first_word_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string word;
  in >> word;
  return word;
}

std::vector<std::string> clock_programs() {
  // /proc/PID/comm has at most 15 characters.
  constexpr std::array<std::string_view, 5> kKnown = {"chronyd", "ntpd", "phc2sys", "ptp4l", "systemd-timesyn"};
  std::vector<std::string> running;
  std::error_code error;
  for (std::filesystem::directory_iterator entry("/proc", error), end; !error && entry != end; entry.increment(error)) {
    if (std::isdigit(static_cast<unsigned char>(entry->path().filename().string().front())) == 0) continue;
    const std::string name = first_word_of(entry->path() / "comm");
    if (std::ranges::find(kKnown, name) != kKnown.end() && std::ranges::find(running, name) == running.end())
      running.push_back(name);
  }
  std::ranges::sort(running);
  return running;
}

checks::ClockFacts read_clock() {
  checks::ClockFacts clock;
  timex state{};
  const int result = adjtimex(&state);
  clock.is_synchronised = result >= 0 && result != TIME_ERROR && (state.status & STA_UNSYNC) == 0;
  clock.offset = (state.status & STA_NANO) != 0 ? state.offset / 1000 : state.offset;
  clock.greatest_error = state.maxerror;
  clock.programs = clock_programs();
  return clock;
}

checks::ProcessorFacts read_processor() {
  checks::ProcessorFacts processor;
  cpu_set_t cores;
  CPU_ZERO(&cores);
  if (sched_getaffinity(0, sizeof cores, &cores) == 0) processor.cores = CPU_COUNT(&cores);
  const std::filesystem::path frequency = "/sys/devices/system/cpu/cpu0/cpufreq";
  processor.governor = first_word_of(frequency / "scaling_governor");
  processor.driver = first_word_of(frequency / "scaling_driver");
  return processor;
}

}  // namespace

checks::HostFacts read_host() {
  return {read_clock(), read_processor()};
}

}  // namespace curbstone::doctor::facts
