#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "services/viewer/frames/page_feed.hpp"

namespace curbstone::viewer {

/// What a page wants of a log that is played; all are optional.
struct PlayOrder {
  std::optional<bool> pause;
  std::optional<double> speed;     ///< times the pace of the drive; any positive number
  std::optional<double> position;  ///< s since the first record; any number that is not negative
};

/// What a page said (frames/README.md); one that makes sense has one of these.
struct PageWords {
  bool resumes = false;                         ///< it begins, or has come again
  std::optional<frames::PageFeed::Resume> has;  ///< with it: up to where it knows the map
  std::optional<std::uint32_t> drawn;           ///< the frame that is on its screen
  std::optional<PlayOrder> play;
  std::optional<bool> points;  ///< whether it shows the LiDAR's points
};

/// Anybody may write to the port: what is of another type, or out of all bounds, is as if it was not said.
[[nodiscard]] PageWords read_page_words(const std::string& text);

}  // namespace curbstone::viewer
