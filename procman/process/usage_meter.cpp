#include "procman/process/usage_meter.hpp"

namespace curbstone::procman::process {

void UsageMeter::sample(procman_lcm::deputy_info_t& info) {
  const MachineInfo now = read_machine();
  ticks_passed_ = machine_.cpu_ticks_total == 0 ? 0 : now.cpu_ticks_total - machine_.cpu_ticks_total;
  const std::int64_t idle = now.cpu_ticks_idle - machine_.cpu_ticks_idle;
  info.cpu_load = ticks_passed_ > 0 ? 1.0F - static_cast<float>(idle) / static_cast<float>(ticks_passed_) : 0.0F;
  info.phys_mem_total_bytes = now.memory_total;
  info.phys_mem_free_bytes = now.memory_free;
  info.swap_total_bytes = now.swap_total;
  info.swap_free_bytes = now.swap_free;
  machine_ = now;
  ticks_ = std::move(next_ticks_);
  next_ticks_.clear();
}

void UsageMeter::measure(pid_t pid, procman_lcm::cmd_status_t& status) {
  const auto process = pid == 0 ? std::nullopt : read_process(pid);
  if (!process) return;
  const auto before = ticks_.find(pid);
  if (before != ticks_.end() && ticks_passed_ > 0) {
    status.cpu_usage = static_cast<float>(process->cpu_ticks - before->second) / static_cast<float>(ticks_passed_);
  }
  next_ticks_[pid] = process->cpu_ticks;
  status.mem_vsize_bytes = process->memory_virtual;
  status.mem_rss_bytes = process->memory_resident;
}

}  // namespace curbstone::procman::process
