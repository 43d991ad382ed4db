#pragma once

#include <filesystem>
#include <string>

namespace curbstone::output {

/// A file that a command writes under another name, and that gets its own when it is whole. A device or a pipe
/// (/dev/null, say) is written to as it is, and stays. Everything throws std::runtime_error with one line that names
/// the file.
class NewFile {
 public:
  /// Without `force` a file of that name is not replaced.
  NewFile(std::filesystem::path file, bool force);
  ~NewFile();
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// Where to write until then.
  [[nodiscard]] std::string part() const { return part_.string(); }
  /// Gives the file its name.
  void commit();

 private:
  std::filesystem::path file_;
  std::filesystem::path part_;  // the file itself, where it is no regular one
};

}  // namespace curbstone::output
