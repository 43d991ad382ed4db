#pragma once

#include <cstdint>
#include <curbstone/service_status_t.hpp>
#include <deque>
#include <set>
#include <string>
#include <vector>

namespace curbstone::viewer::foxglove {

/// The status of all processes, for plots and for a log: the last SERVICE_STATUS of each as JSON, and a log line
/// whenever a process starts and whenever a fault begins or ends. Bounded. Pure; one thread.
class StatusHistory {
 public:
  static constexpr std::size_t kMaxServices = 64;
  static constexpr std::size_t kMaxLines = 256;     ///< the newest ones
  static constexpr std::size_t kMaxText = 300;      ///< bytes of a name or a fault
  static constexpr std::size_t kMaxFaults = 16;     ///< per process
  static constexpr std::size_t kMaxCounters = 256;  ///< per process

  struct Service {
    std::string name;
    std::string topic;         ///< "/status/tensor_voting_1"
    std::string json;          ///< of the last message
    std::uint64_t number = 0;  ///< increases with each message
    std::int64_t utime = 0;    ///< us, of the last message
    std::int32_t pid = 0;
    std::int64_t uptime = 0;  ///< us
    std::int64_t cpu_time = 0;
    std::set<std::string> faults = {};
  };
  enum class Level { kInfo, kError };
  struct Line {
    std::uint64_t number = 0;  ///< from 1
    std::int64_t utime = 0;    ///< us
    Level level = Level::kInfo;
    std::string name;  ///< of the process
    std::string text;  ///< UTF-8
  };

  /// False: kMaxServices is reached and this process is not among them.
  bool put(const service_status_t& message);
  /// In the order of their first message. None is ever removed.
  [[nodiscard]] const std::vector<Service>& services() const { return services_; }
  /// The newest kMaxLines.
  [[nodiscard]] const std::deque<Line>& lines() const { return lines_; }

 private:
  void add_line(const service_status_t& message, Level level, const std::string& name, std::string text);

  std::vector<Service> services_;
  std::deque<Line> lines_;
  std::uint64_t number_ = 0;
};

/// foxglove.Log, as protobuf.
[[nodiscard]] std::string log_message(const StatusHistory::Line& line);

}  // namespace curbstone::viewer::foxglove
