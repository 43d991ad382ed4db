#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string_view>
#include <vector>

#include "services/viewer/frames/sections.hpp"

namespace curbstone::viewer::frames {

/// The present state of everything that pages show.
struct World {
  double run = 0;  ///< random id of this process run
  std::int32_t epoch = 0;
  const store::LiveMap& map;
  const TileSteps& steps;  ///< closed (TileSteps::close())
  const store::CurbLines& curbs;
  const store::MarkingLines& markings;
  const store::ThinnedPath& path;
  const std::vector<ScanPoint>& scan;
  std::uint64_t scan_number = 0;  ///< increases with each scan
  std::string_view services;      ///< JSON
  std::uint64_t services_number = 0;
  std::int64_t newest_utime = 0;  ///< us, of the map points in the newest tile
  const store::DenseCloud* cloud = nullptr;
  std::int64_t now = 0;  ///< us, for the rate of the cloud
};

/// Keeps track of what one page has, and makes the frames with what it lacks. At most kMaxOut frames may be
/// unacknowledged, so the cost of a page is bounded whatever it does. Pure; one thread.
class PageFeed {
 public:
  static constexpr std::size_t kMaxOut = 2;
  static constexpr std::size_t kMaxWholeTiles = 64;  ///< in one frame: 200 kB

  /// What a page reports to have from an earlier connection.
  struct Resume {
    double run = 0;
    std::int32_t epoch = 0;
    std::uint64_t number = 0;
  };
  explicit PageFeed(std::optional<Resume> resume) : resume_(resume) {}

  /// Makes the next frame begin with BEGIN, which discards everything the page has.
  void restart() {
    epoch_.reset();
    resume_.reset();
    newest_utime_ = 0;
  }
  void want_points(bool wanted) { wants_points_ = wanted; }
  [[nodiscard]] bool wants_points() const { return wants_points_; }

  void want_cloud(const CloudWish& wish) { cloud_.want(wish); }
  [[nodiscard]] const CloudWish& cloud_wish() const { return cloud_.wish(); }

  [[nodiscard]] bool may_send() const { return out_.size() < kMaxOut; }
  /// Whether the page lacks tiles that the shared steps do not bring.
  [[nodiscard]] bool is_behind(const World& world) const;
  /// Makes the next frame; may_send() must be true.
  [[nodiscard]] std::vector<std::uint8_t> make(const World& world, std::string_view state);

  /// The page acknowledges frame `frame` as drawn, and with it all earlier ones. Returns the newest utime that these
  /// frames showed for the first time, us; 0 if none did. Empty: no such frame is unacknowledged.
  std::optional<std::int64_t> drawn(std::uint32_t frame);

 private:
  void begin(ByteWriter& out, const World& world);

  struct Out {
    std::uint32_t frame;
    std::int64_t newest_utime;  // 0: no newer points than in earlier frames
  };
  std::optional<Resume> resume_;
  std::optional<std::int32_t> epoch_;  // empty: nothing was sent yet
  std::uint64_t number_ = 0;
  std::uint32_t curbs_number_ = 0;
  std::uint32_t markings_number_ = 0;
  std::uint32_t path_round_ = 0;
  std::size_t path_points_ = 0;
  std::uint64_t scan_number_ = 0;
  std::optional<std::int64_t> scan_sent_;  // us
  std::uint64_t services_number_ = 0;
  std::int64_t newest_utime_ = 0;
  bool wants_points_ = false;
  CloudFeed cloud_;
  std::uint32_t last_frame_ = 0;
  std::deque<Out> out_;
};

}  // namespace curbstone::viewer::frames
