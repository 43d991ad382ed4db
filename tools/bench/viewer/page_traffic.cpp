#include "tools/bench/viewer/page_traffic.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <stdexcept>
#include <utility>

#include "common/bus/local_bus.hpp"
#include "services/viewer/viewer_node.hpp"
#include "tools/output/ordered_log.hpp"
#include "tools/output/watched_log.hpp"
#include "tools/replay/vehicle.hpp"

namespace curbstone::bench::viewer {
namespace {

using curbstone::viewer::ViewerConfig;
using curbstone::viewer::ViewerNode;
namespace web = curbstone::viewer::web;

constexpr std::int64_t kTick = 20'000;  // us
enum PageNumber : web::PageId { kMap = 1, kPoints = 2, kUnread = 3, kCloud = 4 };

/// By kind: frames/README.md.
constexpr std::array<const char*, 10> kSections = {"",       "begin", "tiles",    "curbs",    "path",
                                                   "points", "state", "services", "markings", "cloud"};

std::uint32_t u32_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// The size after permessage-deflate (RFC 7692 7.2.1): raw deflate, each message by itself, without the last four
/// bytes.
std::int64_t compressed_size(const std::vector<std::uint8_t>& message) {
  z_stream stream{};
  if (deflateInit2(&stream, web::kCompression, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  std::vector<std::uint8_t> out(deflateBound(&stream, message.size()) + 16);
  stream.next_in = const_cast<Bytef*>(message.data());
  stream.avail_in = static_cast<uInt>(message.size());
  stream.next_out = out.data();
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_SYNC_FLUSH);
  const auto size = static_cast<std::int64_t>(stream.total_out) - 4;
  deflateEnd(&stream);
  return size;
}

/// Pages that acknowledge each frame at once, except kUnread, which never does.
class CountingConnections final : public web::Connections {
 public:
  CountingConnections() {
    for (const web::PageId page : {kMap, kPoints, kUnread, kCloud}) {
      tell(page, Event::Kind::kConnected, "");
      tell(page, Event::Kind::kMessage, R"({"resume": null})");
    }
    tell(kPoints, Event::Kind::kMessage, R"({"points": true})");
    tell(kCloud, Event::Kind::kMessage, R"({"cloud": {"wide": true, "saliency": true}})");
  }
  std::vector<Event> take_events() override { return std::exchange(events_, {}); }
  void send(web::PageId page, web::Frame frame) override {
    PageTraffic& traffic = pages_[page];
    const auto size = static_cast<std::int64_t>(frame->size());
    traffic.bytes += size;
    traffic.compressed += compressed_size(*frame);
    traffic.frames += 1;
    traffic.largest = std::max(traffic.largest, size);
    const std::uint32_t number = u32_at(*frame, 0);
    for (std::size_t at = 4; at + 5 <= frame->size(); at += 5 + u32_at(*frame, at + 1))
      traffic.sections[kSections.at((*frame)[at])] += 5 + u32_at(*frame, at + 1);
    if (page != kUnread) tell(page, Event::Kind::kMessage, fmt::format(R"({{"ack": {}}})", number));
  }
  void send_text(web::PageId, std::string) override {}
  [[nodiscard]] std::size_t queued(web::PageId) const override { return 0; }
  [[nodiscard]] Counters counters() const override { return {}; }
  [[nodiscard]] PageTraffic of(web::PageId page) { return pages_[page]; }

 private:
  void tell(web::PageId page, Event::Kind kind, std::string text) {
    events_.push_back({page, kind, std::move(text), 0});
  }
  std::vector<Event> events_;
  std::map<web::PageId, PageTraffic> pages_;
};

}  // namespace

DriveTraffic measure_traffic(const std::string& log) {
  output::WatchedLog reader(log, "bench viewer");
  LocalBus bus;
  CountingConnections connections;
  const ViewerConfig config;
  ViewerNode node(config, bus, connections, {});
  node.connect(bus);
  replay::ReplayOptions options;
  options.assignments = {"mapper.folder=", "semantic_map.map="};  // writes nothing to the disk
  options.tick_period = kTick;
  replay::ReplayVehicle vehicle(options, bus);
  std::map<std::pair<std::int32_t, std::int32_t>, semantic_tile_t> tiles;
  bus.subscribe<semantic_tile_t>("SEMANTIC_TILE", [&](const semantic_tile_t& tile) {
    tiles[{tile.tile_x, tile.tile_y}] = tile;
  });
  std::int64_t first = 0, now = 0;
  while (const auto event = reader.next()) {
    if (!output::is_of_a_driver(event->channel)) continue;
    if (first == 0) first = event->log_utime;
    if (event->log_utime - now >= kTick) {
      now = event->log_utime;
      vehicle.advance(now);
      bus.dispatch();
      node.tick(now);
    }
    bus.inject(event->channel, event->bytes.data(), static_cast<int>(event->bytes.size()));
    bus.dispatch();
  }
  if (now <= first) throw std::runtime_error(log + ": holds no LIDAR_POINTS, IMU or WHEELS");
  DriveTraffic traffic{.seconds = static_cast<double>(now - first) * 1e-6,
                       .map = connections.of(kMap),
                       .points = connections.of(kPoints),
                       .cloud = connections.of(kCloud),
                       .unread = connections.of(kUnread),
                       .tiles = {}};
  for (const auto& [key, tile] : tiles) traffic.tiles.push_back(tile);
  return traffic;
}

}  // namespace curbstone::bench::viewer
