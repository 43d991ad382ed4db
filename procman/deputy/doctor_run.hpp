#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/shell/event_loop.hpp"
#include "procman/process/file_descriptor.hpp"

namespace curbstone::procman::deputy {

/// The findings in the JSON of `curbstone doctor`, one line each with its fix; nothing if the text is not such JSON.
[[nodiscard]] std::optional<std::vector<std::string>> doctor_findings(const std::string& json);

/// Runs `curbstone doctor` in the background. Its process is killed with the owner. The loop must outlive it.
class DoctorRun {
 public:
  /// `done` receives the findings, or nothing if doctor could not be run; the owner may destroy this object in it.
  /// Throws std::system_error if no pipe can be created.
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
