#pragma once

#include <string>

#include "tools/output/new_file.hpp"

namespace curbstone::replay {

/// The map file that a replay writes. It gets its name when it is complete; until then an earlier map keeps the name. A
/// file that is not a map is not replaced: it may be a user's only recording. All functions throw std::runtime_error
/// with a one-line message that names the file.
class NewMap {
 public:
  explicit NewMap(std::string file);
  ~NewMap();
  NewMap(const NewMap&) = delete;
  NewMap& operator=(const NewMap&) = delete;

  /// The path to write to before commit(). SQLite keeps further files beside it.
  [[nodiscard]] std::string part() const { return whole_.part(); }
  /// Gives the map its name. It must not be open in any process.
  void commit();

 private:
  std::string file_;
  output::NewFile whole_;
};

}  // namespace curbstone::replay
