#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace curbstone::replay {

/// The map file that a replay writes. It is written in a temporary folder beside its destination and gets its name when
/// it is complete; until then an earlier map keeps the name. A file that is not a map is not replaced: it may be a
/// user's only recording. If a log holds more than one drive, semantic_map keeps the maps of the earlier drives in the
/// same folder, and they are moved with the last one. All functions throw std::runtime_error with a one-line message
/// that names the file.
class NewMap {
 public:
  explicit NewMap(std::filesystem::path file);
  ~NewMap();
  NewMap(const NewMap&) = delete;
  NewMap& operator=(const NewMap&) = delete;

  /// The path to write to before commit(). SQLite keeps further files beside it.
  [[nodiscard]] std::string part() const { return (folder_ / file_.filename()).string(); }
  /// `text` with temporary paths replaced by the final ones.
  [[nodiscard]] std::string with_final_names(std::string text) const;
  /// Gives the maps their names and returns the names of the earlier drives' maps. They must not be open in any
  /// process.
  std::vector<std::string> commit();

 private:
  void clear() const;

  std::filesystem::path file_;
  std::filesystem::path folder_;
};

}  // namespace curbstone::replay
