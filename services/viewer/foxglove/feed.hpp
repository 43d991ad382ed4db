#pragma once

#include <cstdint>
#include <curbstone/map_pose_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/config/vehicle.hpp"
#include "services/viewer/foxglove/near_points.hpp"
#include "services/viewer/foxglove/status_book.hpp"
#include "services/viewer/foxglove/topics.hpp"
#include "services/viewer/frames/page_feed.hpp"

namespace curbstone::viewer::foxglove {

/// All that is shown, as it is now.
struct World {
  frames::World map;
  const std::optional<map_pose_t>& pose;  ///< sound
  const VehicleConfig& vehicle;
  const StatusBook& status;
  const NearPoints& points;
};

struct Message {
  std::uint32_t channel = 0;  ///< a Topic
  std::int64_t utime = 0;     ///< us since the Unix epoch: of what was measured
  std::string payload;
};

/// What one listener was sent, be it a client or a file, and so what it lacks. A message is made of what is there when
/// it goes: a slow listener gets fewer of them, and none is old. Pure; one thread.
class Feed {
 public:
  /// A file is entered anywhere, so what changes by pieces (curbs, path) is repeated as a whole there, each 10 s.
  enum class For { kClient, kFile };
  explicit Feed(For listener) : listener_(listener) {}

  /// From now on; the present state comes first, also when it was subscribed to before. Any channel.
  void subscribe(std::uint32_t channel) { sent_.insert_or_assign(channel, Sent{}); }
  void unsubscribe(std::uint32_t channel) { sent_.erase(channel); }
  [[nodiscard]] bool wants(std::uint32_t channel) const { return sent_.contains(channel); }

  /// The messages that are due at `now` (us, a jump of the clock delays nothing). Small ones are states and lines; of
  /// the large ones, maps and clouds, one at most, and none unless `takes_large`.
  [[nodiscard]] std::vector<Message> due(const World& world, std::int64_t now, bool takes_large);

 private:
  struct Sent {
    std::optional<std::int64_t> at;     // us; nothing yet
    std::optional<std::int64_t> whole;  // us, everything of it
    std::uint64_t number = 0;           // of what was sent
    std::size_t points = 0;             // of the path
    TileKey middle;                     // of the window
  };
  using Sink = std::vector<Message>;
  /// Null unless the channel is subscribed to, and `period` us have passed since its last message.
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
