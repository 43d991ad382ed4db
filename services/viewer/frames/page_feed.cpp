#include "services/viewer/frames/page_feed.hpp"

#include <algorithm>
#include <cstdlib>

namespace curbstone::viewer::frames {
namespace {

constexpr std::int64_t kScanPeriod =
    200'000;  // us: points are most of what a page gets, and lie where they were measured

}  // namespace

bool PageFeed::is_behind(const World& world) const {
  return epoch_ != world.epoch || !world.steps.from(number_).has_value();
}

void PageFeed::begin(ByteWriter& out, const World& world) {
  const bool goes_on = !epoch_ && resume_ && resume_->run == world.run && resume_->epoch == world.epoch &&
                       resume_->number <= world.map.number();
  number_ = goes_on ? resume_->number : 0;
  curbs_number_ = markings_number_ = 0;
  path_round_ = 0;
  epoch_ = world.epoch;
  cloud_.forget();
  if (!goes_on) write_begin(out, world.run, world.epoch);
}

std::vector<std::uint8_t> PageFeed::make(const World& world, std::string_view state) {
  ByteWriter out;
  out.u32(++last_frame_);
  if (epoch_ != world.epoch) begin(out, world);
  number_ = write_tiles(out, world.map, world.steps, number_, kMaxWholeTiles);
  curbs_number_ = write_curbs(out, world.curbs, curbs_number_);
  markings_number_ = write_markings(out, world.markings, markings_number_);
  const bool everything = path_round_ != world.path.round();
  write_path(out, world.path, everything ? 0 : path_points_, everything);
  path_round_ = world.path.round();
  path_points_ = world.path.points().size();
  const bool is_due = !scan_sent_ || std::abs(world.now - *scan_sent_) >= kScanPeriod;
  if (wants_points_ && scan_number_ != world.scan_number && is_due) {
    write_points(out, world.scan);
    scan_sent_ = world.now;
    scan_number_ = world.scan_number;
  }
  if (world.cloud != nullptr) write_cloud(out, cloud_, *world.cloud, world.now);
  if (services_number_ != world.services_number) {
    write_services(out, world.services);
    services_number_ = world.services_number;
  }
  write_state(out, state);

  const bool is_level = number_ == world.map.number();
  const bool is_news = is_level && world.newest_utime > newest_utime_;
  out_.push_back({last_frame_, is_news ? world.newest_utime : 0});
  if (is_news) newest_utime_ = world.newest_utime;
  return out.take();
}

std::optional<std::int64_t> PageFeed::drawn(std::uint32_t frame) {
  const bool is_out = std::any_of(out_.begin(), out_.end(), [&](const Out& sent) { return sent.frame == frame; });
  if (!is_out) return std::nullopt;
  std::int64_t newest = 0;
  while (!out_.empty() && out_.front().frame <= frame) {
    newest = std::max(newest, out_.front().newest_utime);
    out_.pop_front();
  }
  return newest;
}

}  // namespace curbstone::viewer::frames
