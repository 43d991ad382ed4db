#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/shell/event_loop.hpp"
#include "procman/process/file_descriptor.hpp"

namespace curbstone::procman::deputy {

/// What the JSON of `curbstone doctor` found, a line each with its fix; nothing if it is none.
[[nodiscard]] std::optional<std::vector<std::string>> doctor_findings(const std::string& json);

/// `curbstone doctor`, running beside everything else. It is killed with its owner. The loop must outlive it.
class DoctorRun {
 public:
  /// `done` gets the findings, or nothing when it could not be run; then the owner may end this. Throws
  /// std::system_error if no pipe can be had.
  using Done = std::function<void(std::optional<std::vector<std::string>> findings)>;
  DoctorRun(EventLoop& loop, const std::string& procman_config, const std::string& lcm_url, Done done);
  ~DoctorRun();
  DoctorRun(const DoctorRun&) = delete;
  DoctorRun& operator=(const DoctorRun&) = delete;

 private:
  void read_on();

  EventLoop& loop_;
  Done done_;
  pid_t pid_ = 0;  // 0: not running
  process::FileDescriptor output_;
  std::string text_;
};

}  // namespace curbstone::procman::deputy
