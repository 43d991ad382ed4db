#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace curbstone::recorder {

/// The folder of one recording, FOLDER/2026-11-23T205200Z: drive-000.lcmlog and so on, and config.yaml. As long as this
/// object lives the folder is locked (flock), so that no other recorder deletes it.
class Session {
 public:
  /// Makes the folder and those above it; if there is one of this second, with -2 behind its name. Throws
  /// std::runtime_error with one clear line. `utime`: us since the Unix epoch.
  Session(const std::filesystem::path& folder, std::int64_t utime);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// The first log that is not there yet.
  [[nodiscard]] std::string next_log() const;
  /// Replaces config.yaml, whole or not at all. What cannot be written is left out: the log holds it too.
  void write_config(const std::string& yaml) const;

 private:
  std::filesystem::path path_;
  int lock_ = -1;
};

}  // namespace curbstone::recorder
