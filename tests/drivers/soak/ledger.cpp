#include "tests/drivers/soak/ledger.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

namespace curbstone::test {

namespace {

std::int64_t resident_memory() {
  std::ifstream statm("/proc/self/statm");
  std::int64_t total = 0, resident = 0;
  statm >> total >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

}  // namespace

void Ledger::sent(std::int64_t index, Fate fate) {
  entries_[static_cast<std::size_t>(index) % entries_.size()] = {index, fate, false};
  ++sent_[static_cast<std::size_t>(fate)];
}

void Ledger::used(std::int64_t index, std::int64_t error) {
  if (index < 0) {
    ++strange_;
    return;
  }
  Entry& entry = entries_[static_cast<std::size_t>(index) % entries_.size()];
  if (entry.index != index || entry.used) {
    ++strange_;
  } else {
    entry.used = true;
    ++used_[static_cast<std::size_t>(entry.fate)];
  }
  if (std::abs(error) > kStampError) ++wrong_;
  if (std::abs(error) > std::abs(worst_error_)) worst_error_ = error;
}

void Ledger::look(const NodeReport& report, double share_done) {
  for (std::string fault : report.faults) {
    std::erase_if(fault, [](char c) { return c >= '0' && c <= '9'; });
    if (faults_.size() < 100) faults_.insert(fault);
  }
  // By then a LiDAR driver keeps all the seconds that it may be asked for again.
  if (first_memory_ == 0 && share_done >= 0.25) first_memory_ = resident_memory();
  last_memory_ = resident_memory();
}

void Ledger::print(const std::string& sensor, double hours, double seconds, const NodeReport& report) const {
  fmt::print("{}: {:.3f} h of sensor time in {:.1f} s\n", sensor, hours, seconds);
  for (std::size_t i = 0; i < kFates.size(); ++i) {
    fmt::print("  {:8} {:9} sent {:9} used\n", kFates[i], sent_[i], used_[i]);
  }
  fmt::print("  used twice or never sent {}, worst stamp {:.3f} ms ({} off by more than 1 ms), memory {:+.1f} MB\n",
             strange_, static_cast<double>(worst_error_) * 1e-3, wrong_, static_cast<double>(growth()) / (1 << 20));
  for (const auto& [name, value] : report.counters.values()) {
    for (const char* kind : {"refused.", "lost.", "withheld.", "dropped.", "clock"}) {
      if (name.starts_with(kind)) fmt::print("  {} {}\n", name, value);
    }
  }
  for (const std::string& fault : faults_) fmt::print("  at times: {}\n", fault);
}

}  // namespace curbstone::test
