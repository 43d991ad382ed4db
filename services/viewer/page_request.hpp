#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "services/viewer/frames/page_feed.hpp"

namespace curbstone::viewer {

/// A page's commands to the player of a log; all are optional.
struct PlaybackCommand {
  std::optional<bool> pause;
  std::optional<double> speed;     ///< times real time; any positive number
  std::optional<double> position;  ///< s since the first record; any number that is not negative
};

/// One message of a page (frames/README.md). A valid message sets one of the members.
struct PageRequest {
  bool resumes = false;                         ///< the page opened, or it reconnected
  std::optional<frames::PageFeed::Resume> has;  ///< with `resumes`: the state that the page kept
  std::optional<std::uint32_t> drawn;           ///< the frame that it has drawn
  std::optional<PlaybackCommand> play;
  std::optional<bool> points;  ///< whether it shows the LiDAR's points
  std::optional<frames::CloudWish> cloud;
};

/// Anybody may write to the port: a value of the wrong type or out of bounds is ignored.
[[nodiscard]] PageRequest parse_page_request(const std::string& text);

}  // namespace curbstone::viewer
