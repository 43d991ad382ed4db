#pragma once

#include <string>

#include "tools/output/new_file.hpp"

namespace curbstone::replay {

/// The map that a replay makes: it has its name when it is whole, and until then an earlier map keeps it. What is no
/// map is not replaced: it may be somebody's only recording. Everything throws std::runtime_error with one line that
/// names the file.
class NewMap {
 public:
  explicit NewMap(std::string file);
  ~NewMap();
  NewMap(const NewMap&) = delete;
  NewMap& operator=(const NewMap&) = delete;

  /// Where to write until then. SQLite has files beside it.
  [[nodiscard]] std::string part() const { return whole_.part(); }
  /// Gives the map its name. Nobody may have it open.
  void commit();

 private:
  std::string file_;
  output::NewFile whole_;
};

}  // namespace curbstone::replay
