#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "common/tiles/tile.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "services/viewer/viewer_node.hpp"

namespace curbstone::view {

/// Whether the file is a map rather than a log, by its first bytes. Throws std::runtime_error if it cannot be read.
[[nodiscard]] bool is_map_file(const std::string& file);

/// A map file as the node's map: tiles, curbs, markings and the path. It follows the file: what a mapper adds is added,
/// and a file that takes its place replaces it. One thread.
class ShownMap {
 public:
  /// `node` must outlive this; `title` is the file's, for people.
  ShownMap(std::string file, std::string title, viewer::ViewerNode& node);

  /// Passes the content to the node. `now`: us, as in the node's tick(). Throws MapStoreError.
  void show(std::int64_t now);
  /// Call it about once a second: shows the file again if it changed. If it is gone or cannot be read, the title says
  /// so and the map stays.
  void look(std::int64_t now);

 private:
  /// Of the file and of its write-ahead log.
  struct Mark {
    std::array<std::uint64_t, 2> inode{};
    std::array<std::int64_t, 2> size{};
    std::array<std::int64_t, 2> changed{};  // ns
    bool operator==(const Mark&) const = default;
  };
  [[nodiscard]] Mark mark() const;
  void pass_on(const semantic_map::store::MapReader& reader);

  std::string file_;
  std::string title_;
  viewer::ViewerNode& node_;
  Mark shown_as_;
  std::optional<std::int32_t> epoch_;
  std::int32_t revision_ = 0;                 // of the tiles that the next show() passes on
  std::map<TileKey, std::size_t> passed_on_;  // hashes
};

}  // namespace curbstone::view
