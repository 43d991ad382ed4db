#pragma once

#include <cstdint>
#include <curbstone/map_pose_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/config/vehicle.hpp"
#include "services/viewer/foxglove/near_points.hpp"
#include "services/viewer/foxglove/status_history.hpp"
#include "services/viewer/foxglove/topics.hpp"
#include "services/viewer/frames/page_feed.hpp"

namespace curbstone::viewer::foxglove {

/// The present state of everything that is shown.
struct World {
  frames::World map;
  const std::optional<map_pose_t>& pose;  ///< must be valid (finite)
  const VehicleConfig& vehicle;
  const StatusHistory& status;
  const NearPoints& points;
};

struct Message {
  std::uint32_t channel = 0;  ///< a Topic
  std::int64_t utime = 0;     ///< us since the Unix epoch, of the measurement
  std::string payload;
};

/// Keeps track of what one listener (a client or a file) was sent, and so of what it lacks. A message is made from the
/// present state when it is sent: a slow listener gets fewer messages, but never old ones. Pure; one thread.
class Feed {
 public:
  /// A reader may start anywhere in a file, so there everything that is sent as changes (curbs, markings, path) is
  /// repeated in full every 10 s.
  enum class For { kClient, kFile };
  explicit Feed(For listener) : listener_(listener) {}

  /// Starts sending `channel`, which may be any channel. The present state is sent first, also after an earlier
  /// subscription.
  void subscribe(std::uint32_t channel) { sent_.insert_or_assign(channel, Sent{}); }
  void unsubscribe(std::uint32_t channel) { sent_.erase(channel); }
  [[nodiscard]] bool wants(std::uint32_t channel) const { return sent_.contains(channel); }

  /// The messages that are due at `now` (us; a jump of the clock delays none). States and lines are small. Of the large
  /// messages (maps and clouds) at most one is returned, and none unless `takes_large`.
  [[nodiscard]] std::vector<Message> due(const World& world, std::int64_t now, bool takes_large);

 private:
  struct Sent {
    std::optional<std::int64_t> at;     // us, of the last message; empty: none was sent
    std::optional<std::int64_t> whole;  // us, of the last full message
    std::uint64_t number = 0;           // revision of the data in the last message
    std::size_t points = 0;             // of the path, sent so far
    TileKey middle;                     // of the window in the last message
  };
  using Sink = std::vector<Message>;
  /// Null unless the channel is subscribed to and `period` us have passed since its last message.
  Sent* ready(std::uint32_t channel, std::int64_t now, std::int64_t period);
  [[nodiscard]] bool is_whole_due(const Sent& sent, std::int64_t now) const;

  void send_pose(const World& world, std::int64_t now, Sink& out);
  void send_status(const World& world, std::int64_t now, Sink& out);
  void send_log(const World& world, std::int64_t now, Sink& out);
  template <class Lines, class Message>
  void send_lines(Topic topic, const Lines& lines, const Message& message_of, std::int64_t utime, std::int64_t now,
                  Sink& out);
  void send_path(const World& world, std::int64_t now, Sink& out);
  bool send_scan(const World& world, std::int64_t now, Sink& out);
  bool send_points(const World& world, std::int64_t now, Sink& out);
  bool send_window(const World& world, std::int64_t now, Sink& out);
  bool send_map(const World& world, std::int64_t now, Sink& out);

  For listener_;
  std::map<std::uint32_t, Sent> sent_;
};

}  // namespace curbstone::viewer::foxglove
