#include "common/shell/status_reporter.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

#include "common/bus/levels.hpp"
#include "common/config/version.hpp"
#include "common/shell/process_memory.hpp"

namespace curbstone {

namespace {

std::vector<std::string> kinds_of(const std::vector<std::string>& faults) {
  std::vector<std::string> kinds;
  for (const std::string& fault : faults) kinds.push_back(without_numbers(fault));
  return kinds;
}

std::int64_t cpu_time() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto us = [](const timeval& t) { return std::int64_t{t.tv_sec} * 1'000'000 + t.tv_usec; };
  return us(usage.ru_utime) + us(usage.ru_stime);
}

}  // namespace

std::string host_name() {
  char name[256] = {};
  gethostname(name, sizeof name - 1);
  return name;
}

StatusReporter::StatusReporter(std::string service, std::string config_hash, Clocks clocks, Print print)
    : clocks_(std::move(clocks)), print_(std::move(print)), start_(clocks_.steady()) {
  if (!print_)
    print_ = [](const std::string& line) {  // a full disk behind stderr must not end the process
      (void)std::fputs((line + "\n").c_str(), stderr);
    };
  status_.service = std::move(service);
  status_.host = host_name();
  status_.pid = getpid();
  status_.version = version();
  status_.config_hash = std::move(config_hash);
}

bool StatusReporter::faults_changed(const NodeReport& report) const {
  return kinds_of(report.faults) != reported_;
}

void StatusReporter::publish(Publisher& bus, const Counters& bus_counters, const NodeReport& report) {
  const std::int64_t before = clocks_.steady();
  status_.utime = clocks_.wall();
  clock_step_.read(before, status_.utime, clocks_.steady());
  status_.uptime = clocks_.steady() - start_;
  status_.cpu_time = cpu_time();
  const ProcessMemory memory = process_memory();
  status_.memory = memory.resident;
  status_.latency_p50 = static_cast<float>(report.latency_p50);
  status_.latency_p99 = static_cast<float>(report.latency_p99);
  status_.counter_name.clear();
  status_.counter_value.clear();
  Counters of_process;
  set_level(of_process, "memory.own_kb", memory.own / 1000);
  if (clock_step_.steps() > 0) of_process.set("clock.steps", clock_step_.steps());
  for (const Counters* counters : {&report.counters, &bus_counters, &std::as_const(of_process)}) {
    for (const auto& [name, value] : counters->values()) {
      status_.counter_name.push_back(name);
      status_.counter_value.push_back(value);
    }
  }
  status_.num_counters = static_cast<std::int32_t>(status_.counter_name.size());
  status_.fault = report.faults;
  if (const auto step = clock_step_.recent())
    status_.fault.push_back(
        fmt::format("the clock of this host was set by {:+.0f} ms", static_cast<double>(*step) * 1e-3));
  if (const auto duplicate = duplicate_.fault(status_.utime)) status_.fault.push_back(*duplicate);
  if (const auto second = second_.fault(section_, status_.utime)) status_.fault.push_back(*second);
  status_.num_faults = static_cast<std::int32_t>(status_.fault.size());
  bus.publish("SERVICE_STATUS", status_);
  reported_ = kinds_of(report.faults);
  for (const std::string& line : fault_lines_.update(status_.fault, clocks_.steady()))
    print_(fmt::format("{}: {}", status_.service, line));
}

}  // namespace curbstone
