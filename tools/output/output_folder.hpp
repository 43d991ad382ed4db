#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace curbstone::output {

/// A folder that a command writes into. Files get their names when all are there: nothing half-written stays.
/// Everything throws std::runtime_error with one line that names the file.
class OutputFolder {
 public:
  explicit OutputFolder(std::filesystem::path folder);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// `write` writes the path that it is given.
  void add(const std::string& name, const std::function<void(const std::string& path)>& write);
  void add_bytes(const std::string& name, std::string_view bytes);
  /// This time there is no such file: one of an earlier export would mislead (a projection, say).
  void leave_out(const std::string& name);
  /// Returns the names, in the order of adding.
  std::vector<std::string> commit();

 private:
  std::filesystem::path folder_;
  std::vector<std::pair<std::filesystem::path, std::string>> parts_;  ///< written as, name
  std::vector<std::string> left_out_;
};

}  // namespace curbstone::output
