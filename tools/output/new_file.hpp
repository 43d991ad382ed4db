#pragma once

#include <filesystem>
#include <string>

namespace curbstone::output {

/// A file that a command writes under a temporary name and that gets its final name when it is complete. A device or a
/// pipe (such as /dev/null) is written directly, and is kept. All functions throw std::runtime_error with a one-line
/// message that names the file.
class NewFile {
 public:
  /// Without `force`, an existing file of that name is not replaced.
  NewFile(std::filesystem::path file, bool force);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// The path to write to before commit().
  [[nodiscard]] std::string part() const { return part_.string(); }
  /// Gives the file its final name.
  void commit();

 private:
  std::filesystem::path file_;
  std::filesystem::path part_;  // the file itself, if it is not a regular file
};

}  // namespace curbstone::output
