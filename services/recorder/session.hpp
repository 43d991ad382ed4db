#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace curbstone::recorder {

/// The folder of one recording, FOLDER/2026-11-23T205200Z, with drive-000.lcmlog and so on, and config.yaml. While this
/// object exists the folder is locked (flock), so that no other recorder deletes it.
class Session {
 public:
  /// Creates the folder and its parents; if a folder of this second exists, adds -2 to the name. Throws
  /// std::runtime_error with one clear line. `utime`: us since the Unix epoch.
  Session(const std::filesystem::path& folder, std::int64_t utime);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The name of the first log that does not exist yet. If the folder has been deleted it is made again; throws
  /// std::runtime_error if that fails.
  [[nodiscard]] std::string next_log();
  /// Replaces config.yaml atomically. A failure is ignored: the log contains the configuration too.
  void write_config(const std::string& yaml) const;

 private:
  void lock();

  std::filesystem::path path_;
  int lock_ = -1;
};

}  // namespace curbstone::recorder
