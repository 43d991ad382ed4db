#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/log/log_writer.hpp"

namespace curbstone::recorder {

/// The newest CONFIG of each process. Each file of a session begins with them, so that it documents the vehicle's
/// configuration.
class ConfigCache {
 public:
  /// Takes an encoded CONFIG; accepts any bytes. Returns whether its content is new.
  bool take(const void* data, int size);
  /// Writes all of them with `utime` as the records' time, us.
  void write(LogWriter& log, std::int64_t utime) const;
  /// A vehicle's configuration file: the section of each process, with version and host in comments.
  [[nodiscard]] std::string yaml() const;

 private:
  struct Known {
    std::string section, yaml, version, host;
    std::vector<std::uint8_t> bytes;
  };
  static constexpr std::size_t kMaxProcesses = 200;  // processes; a vehicle does not have more
  std::map<std::string, Known> by_service_;
};

}  // namespace curbstone::recorder
