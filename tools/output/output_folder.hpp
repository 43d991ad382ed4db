#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace curbstone::output {

/// A folder that a command writes into. Files get their final names when all are complete, so no partial output
/// remains, nor a folder that was made for it. All functions throw std::runtime_error with a one-line message that
/// names the file.
class OutputFolder {
 public:
  explicit OutputFolder(std::filesystem::path folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// `write` writes to the path passed to it.
  void add(const std::string& name, const std::function<void(const std::string& path)>& write);
  void add_bytes(const std::string& name, std::string_view bytes);
  /// This export has no such file. commit() removes one of an earlier export, which would mislead (for example a
  /// projection).
  void leave_out(const std::string& name);
  /// Gives all files their names. Returns the names, in the order of adding.
  std::vector<std::string> commit();

 private:
  std::filesystem::path folder_;
  std::vector<std::pair<std::filesystem::path, std::string>> parts_;  ///< path written to, name
  std::vector<std::string> left_out_;
  std::vector<std::filesystem::path> made_;  ///< folders that were not there before, the innermost first
};

}  // namespace curbstone::output
