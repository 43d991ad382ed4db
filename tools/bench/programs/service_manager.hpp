#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "tools/bench/programs/background_program.hpp"

namespace curbstone::bench::programs {

/// What systemd is to a unit with FileDescriptorStoreMax=: keeps the descriptors that its program sends, and passes
/// them to the next one (sd_notify(3), sd_listen_fds(3)). Destroyed, or told so, it closes them.
class ServiceManager {
 public:
  ServiceManager();
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  [[nodiscard]] std::unique_ptr<BackgroundProgram> start(const std::string& line, const std::string& output_file);
  /// As when the service is stopped for good.
  void close_all();
  [[nodiscard]] std::size_t kept() const;

 private:
  void receive();

  int socket_ = -1;
  std::string address_;  // of it, for NOTIFY_SOCKET
  mutable std::mutex mutex_;
  std::map<std::string, int> kept_;  // by name
  std::atomic<bool> ends_{false};
  std::thread receiver_;
};

}  // namespace curbstone::bench::programs
