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

struct DoctorResult {
  std::optional<std::vector<std::string>> findings;  ///< nothing if doctor could not be run
  std::string why_not;                               ///< the reason, in words
};

/// Runs `curbstone doctor` in the background. Its process is killed with the owner. The loop must outlive it.
class DoctorRun {
 public:
  /// The owner may destroy this object in `done`. Throws std::system_error if no pipe can be created.
  using Done = std::function<void(DoctorResult result)>;
  DoctorRun(EventLoop& loop, const std::string& procman_config, const std::string& lcm_url, Done done);
  ~DoctorRun();
  DoctorRun(const DoctorRun&) = delete;
  DoctorRun& operator=(const DoctorRun&) = delete;

 private:
  void read_on();
  [[nodiscard]] std::string why_without_report() const;

  EventLoop& loop_;
  Done done_;
  pid_t pid_ = 0;  // 0: not running
  process::FileDescriptor output_;
  process::FileDescriptor errors_;  // a file in memory
  std::string text_;
  std::string start_error_;
};

}  // namespace curbstone::procman::deputy
