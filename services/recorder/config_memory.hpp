#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/log/log_writer.hpp"

namespace curbstone::recorder {

/// The newest CONFIG of each process, so that each file of a session begins with how the vehicle is configured.
class ConfigMemory {
 public:
  /// Takes a CONFIG. Returns whether it says something new. Any bytes may come.
  bool take(const void* data, int size);
  /// Writes them all, with this time as the records' time, us.
  void write(LogWriter& log, std::int64_t utime) const;
  /// A vehicle's file: the section of each process, with version and host in comments.
  [[nodiscard]] std::string yaml() const;

 private:
  struct Known {
    std::string section, yaml, version, host;
    std::vector<std::uint8_t> bytes;
  };
  static constexpr std::size_t kMost = 200;  // processes; more are not the vehicle's
  std::map<std::string, Known> by_service_;
};

}  // namespace curbstone::recorder
