#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace curbstone::replay {

<<<<<<< HEAD
/// The map that a replay makes. It is written in a folder of its own beside its place, and gets its name once it is
/// whole: until then an earlier map keeps it. A file that is no map is not replaced: it may be somebody's only
/// recording. Where a log holds more than one drive, semantic_map keeps the earlier ones beside the last one; they move
/// with it. Everything throws std::runtime_error with one line that names the file.
=======
/// The map file that a replay writes. It gets its name when it is complete; until then an earlier map keeps the name. A
/// file that is not a map is not replaced: it may be a user's only recording. All functions throw std::runtime_error
/// with a one-line message that names the file.
>>>>>>> wordsD
class NewMap {
 public:
  explicit NewMap(std::filesystem::path file);
  ~NewMap();
  NewMap(const NewMap&) = delete;
  NewMap& operator=(const NewMap&) = delete;

<<<<<<< HEAD
  /// Where to write until then. SQLite has files beside it.
  [[nodiscard]] std::string part() const { return (folder_ / file_.filename()).string(); }
  /// `text` with the names that the files will have.
  [[nodiscard]] std::string with_final_names(std::string text) const;
  /// Gives the maps their names, and returns those of earlier drives. Nobody may have them open.
  std::vector<std::string> commit();
=======
  /// The path to write to before commit(). SQLite keeps further files beside it.
  [[nodiscard]] std::string part() const { return whole_.part(); }
  /// Gives the map its name. It must not be open in any process.
  void commit();
>>>>>>> wordsD

 private:
  void clear() const;

  std::filesystem::path file_;
  std::filesystem::path folder_;
};

}  // namespace curbstone::replay
