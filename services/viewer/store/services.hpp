#pragma once

#include <cstdint>
#include <curbstone/service_status_t.hpp>
#include <map>
#include <string>
#include <vector>

namespace curbstone::viewer::store {

/// The state of the processes by their last SERVICE_STATUS. A silent process is kept and shows by its age. The number
/// of processes and what is kept of each message are bounded. Pure; one thread.
class Services {
 public:
  static constexpr std::size_t kMaxServices = 64;
  static constexpr std::size_t kMaxText = 300;     ///< bytes of a fault or a name
  static constexpr std::size_t kMaxFaults = 16;    ///< per process
  static constexpr std::size_t kMaxCounters = 64;  ///< per process; only those that count losses

  /// A counter of lost or refused messages.
  struct Loss {
    std::string name;  ///< "dropped.queue"
    std::int64_t count = 0;
    double rate = 0;  ///< 1/s, over the last two messages
  };
  struct Service {
    std::string name;
    std::string host;
    std::string version;
    std::int32_t pid = 0;
    std::int64_t heard = 0;     ///< us, when the last message was received
    std::int64_t uptime = 0;    ///< us
    std::int64_t cpu_time = 0;  ///< us
    double cpu = 0;             ///< cores, over the last two messages
    std::int64_t memory = 0;    ///< bytes
    float latency_p50 = 0;      ///< s; NaN: none
    float latency_p99 = 0;
    std::vector<std::string> faults = {};
    std::vector<Loss> losses = {};
  };

  /// False: kMaxServices is reached and this process is not among them.
  bool put(const service_status_t& message, std::int64_t now);
  [[nodiscard]] const std::map<std::string, Service>& all() const { return services_; }

 private:
  std::map<std::string, Service> services_;
};

}  // namespace curbstone::viewer::store
