#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "common/config/config.hpp"

namespace curbstone::recorder {

/// The `recorder:` section of a vehicle's file.
struct RecorderConfig {
  std::string folder = "/var/log/curbstone";
  std::string file;
  double keep_free = 10;  ///< GB
  int split_mb = 1000;    ///< MB
  int queue = 20'000;     ///< messages
  std::string skip = "VOTED_POINTS";
  std::string large_channels;

  /// The items of large_channels.
  [[nodiscard]] std::vector<std::string> large() const {
    std::vector<std::string> names;
    std::istringstream list(large_channels);
    for (std::string name; std::getline(list, name, ',');) {
      const auto first = name.find_first_not_of(' ');
      if (first != std::string::npos) names.push_back(name.substr(first, name.find_last_not_of(' ') + 1 - first));
    }
    return names;
  }

  void visit(ConfigVisitor& v) {
    v.field("folder", folder,
            "each start makes a folder in it, named by its time in UTC, with the logs of the session");
    v.field("file", file, "instead of a session: this LCM log; if there is one of that name, FILE.1 and so on");
    v.field("keep_free", keep_free, {0, 1e6},
            "GB of the disk that sessions leave free: the oldest are deleted for it; 0: none is ever deleted");
    v.field("split_mb", split_mb, {0, 1'000'000}, "MB, when to go on in the next file; 0: never");
    v.field("queue", queue, {100, 1'000'000}, "messages that wait for a busy disk; 20000 are some 20 s and 100 MB");
    v.field("skip", skip, "channel that is not written: half of all bytes, and a replay makes them again; '': none");
    v.field(
        "large_channels", large_channels,
        "NAME,NAME: channels of foreign programs whose messages of more than 64 kB (16 MB at most) are recorded too");
  }
};

}  // namespace curbstone::recorder
