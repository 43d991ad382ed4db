#include "services/viewer/frames/sections.hpp"

#include <algorithm>
#include <limits>

#include "services/viewer/frames/tile_records.hpp"

namespace curbstone::viewer::frames {
namespace {

enum Kind : std::uint8_t { kBegin = 1, kTiles, kCurbs, kPath, kPoints, kState, kServices, kMarkings, kCloud };

/// Writes the head of a section, and fills in its length when the section is complete.
class Section {
 public:
  Section(ByteWriter& out, Kind kind) : out_(out) {
    out_.u8(kind);
    length_ = out_.size();
    out_.u32(0);
  }
  ~Section() { out_.set_u32(length_, static_cast<std::uint32_t>(out_.size() - length_ - 4)); }
  Section(const Section&) = delete;
  Section& operator=(const Section&) = delete;

 private:
  ByteWriter& out_;
  std::size_t length_ = 0;
};

void write_line(ByteWriter& out, std::uint32_t name, const curb_line_t& line) {
  const std::size_t n = std::min<std::size_t>(line.x.size(), std::numeric_limits<std::uint16_t>::max());
  out.u32(name);
  out.f32(line.confidence);
  out.u8(static_cast<std::uint8_t>((line.dropped != 0 ? 1 : 0) | (line.inferred != 0 ? 2 : 0)));
  out.i8(line.rise);
  out.u16(static_cast<std::uint16_t>(n));
  for (const auto* list : {&line.x, &line.y, &line.z, &line.height, &line.high_side_x, &line.high_side_y}) {
    for (std::size_t i = 0; i < n; ++i) out.f32((*list)[i]);
  }
}

void write_line(ByteWriter& out, std::uint32_t name, const marking_line_t& line) {
  const std::size_t n = std::min<std::size_t>(line.x.size(), std::numeric_limits<std::uint16_t>::max());
  out.u32(name);
  out.i8(line.type);
  out.f32(line.confidence);
  out.f32(line.width);
  out.u16(static_cast<std::uint16_t>(n));
  for (const auto* list : {&line.x, &line.y, &line.z}) {
    for (std::size_t i = 0; i < n; ++i) out.f32((*list)[i]);
  }
  for (std::size_t i = 0; i < n; ++i) out.u8(line.painted[i] != 0 ? 1 : 0);
}

template <class Lines>
std::uint32_t write_lines(ByteWriter& out, Kind kind, const Lines& lines, std::uint32_t number) {
  if (number == lines.number()) return number;
  const auto changes = lines.above(number);
  const Section section(out, kind);
  out.u32(changes.number);
  out.u8(changes.everything ? 1 : 0);
  out.u32(static_cast<std::uint32_t>(changes.gone.size()));
  for (const std::uint32_t name : changes.gone) out.u32(name);
  out.u32(static_cast<std::uint32_t>(changes.added.size()));
  for (const auto& added : changes.added) write_line(out, added.name, *added.line);
  return changes.number;
}

}  // namespace

void write_begin(ByteWriter& out, double run, std::int32_t epoch) {
  const Section section(out, kBegin);
  out.f64(run);
  out.i32(epoch);
}

std::uint64_t write_tiles(ByteWriter& out, const store::LiveMap& map, const TileSteps& steps, std::uint64_t number,
                          std::size_t max_tiles) {
  if (number == map.number()) return number;
  const auto way = steps.from(number);
  if (way) {
    const Section section(out, kTiles);
    out.f64(static_cast<double>(map.number()));
    for (const TileSteps::Step* step : *way) out.bytes(step->records);
    return map.number();
  }
  const auto changes = map.above(number, max_tiles);
  const std::uint64_t last = changes.size() < max_tiles ? map.number() : changes.back().number;
  const Section section(out, kTiles);
  out.f64(static_cast<double>(last));
  for (const auto& change : changes) write_tile(out, change.key, *change.cells);
  return last;
}

std::uint32_t write_curbs(ByteWriter& out, const store::CurbLines& curbs, std::uint32_t number) {
  return write_lines(out, kCurbs, curbs, number);
}

std::uint32_t write_markings(ByteWriter& out, const store::MarkingLines& markings, std::uint32_t number) {
  return write_lines(out, kMarkings, markings, number);
}

void write_path(ByteWriter& out, const store::ThinnedPath& path, std::size_t first, bool everything) {
  if (first >= path.points().size() && !everything) return;
  const Section section(out, kPath);
  out.u8(everything ? 1 : 0);
  for (std::size_t i = first; i < path.points().size(); ++i) {
    out.f32(path.points()[i].x);
    out.f32(path.points()[i].y);
    out.f32(path.points()[i].z);
  }
}

void write_points(ByteWriter& out, const std::vector<ScanPoint>& points) {
  const Section section(out, kPoints);
  for (const ScanPoint& point : points) {
    out.i16(point.x);
    out.i16(point.y);
    out.i16(point.z);
    out.u8(point.intensity);
  }
}

void write_cloud(ByteWriter& out, CloudFeed& feed, const store::DenseCloud& cloud, std::int64_t now) {
  if (!feed.has_news(cloud)) return;
  const Section section(out, kCloud);
  feed.write(out, cloud, now);
}

void write_state(ByteWriter& out, std::string_view json) {
  const Section section(out, kState);
  out.text(json);
}

void write_services(ByteWriter& out, std::string_view json) {
  const Section section(out, kServices);
  out.text(json);
}

}  // namespace curbstone::viewer::frames
