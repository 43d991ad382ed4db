#include "services/tensor_voting/voted_pages.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/tensor_voting/decomposition.hpp"

namespace curbstone {

namespace {

/// A decomposition as the message carries it.
struct WireTensor {
  std::int16_t normal[3];
  std::int8_t tangent[3];
  std::uint8_t stick;
  std::uint8_t plate;
  float mass;
};

WireTensor to_wire(const DecompositionF& d) {
  WireTensor wire;
  for (int axis = 0; axis < 3; ++axis) {
    wire.normal[axis] = static_cast<std::int16_t>(std::lround(d.normal[axis] * 32767));
    wire.tangent[axis] = static_cast<std::int8_t>(std::lround(d.tangent[axis] * 127));
  }
  wire.stick = static_cast<std::uint8_t>(std::lround(d.stick * 255));
  wire.plate = static_cast<std::uint8_t>(std::lround(d.plate * 255));
  wire.mass = d.mass;
  return wire;
}

/// Of the voters of one scale that are sent.
struct WireTensors {
  std::vector<std::uint32_t> points;  // indices in the tile
  std::vector<WireTensor> tensors;
};

WireTensors tensors_changed(const VotingField& field, TileKey key, std::int64_t since) {
  WireTensors wires;
  const std::vector<std::uint32_t> voters = field.voters_changed(key, since);
  const auto points = field.points_of_voters(key);
  for (const std::uint32_t voter : voters) wires.points.push_back(points[voter]);
  std::vector<TensorF> tensors;
  tensors.reserve(voters.size());
  for (const VoteSums& sums : field.sums(key, voters)) {
    tensors.push_back(to_float(to_tensor(sums, field.parameters().ball)));
  }
  wires.tensors.reserve(voters.size());
  for (const DecompositionF& d : decompose(tensors)) wires.tensors.push_back(to_wire(d));
  return wires;
}

/// Fills pages one after the other.
class PageWriter {
 public:
  PageWriter(voted_points_t header, std::size_t num_scales)
      : header_(std::move(header)), point_bytes_(7 + 4 * num_scales) {
    begin_page();
  }

  /// As many points as the page still holds go to it: how many of `count`, at least one.
  std::size_t room_for_points(std::size_t count) { return room(count, point_bytes_); }
  std::size_t room_for_tensors(std::size_t count) { return room(count, kTensorBytes); }
  voted_points_t& page() { return pages_.back(); }

  std::vector<voted_points_t> finish() {
    for (voted_points_t& page : pages_) {
      page.num_pages = static_cast<std::int32_t>(pages_.size());
      page.num_voters = static_cast<std::int32_t>(page.voter.size());
      page.num_tensors = static_cast<std::int32_t>(page.point.size());
    }
    return std::move(pages_);
  }

 private:
  static constexpr std::size_t kTensorBytes = 1 + 4 + 3 * sizeof(std::int16_t) + 3 + 2 + sizeof(float);
  static constexpr std::size_t kHeaderBytes = 200;

  void begin_page() {
    header_.page = static_cast<std::int32_t>(pages_.size());
    pages_.push_back(header_);
    left_ = kMaxPageBytes - kHeaderBytes;
  }
  std::size_t room(std::size_t count, std::size_t bytes) {
    if (left_ < bytes) begin_page();
    const std::size_t fit = std::min(count, left_ / bytes);
    left_ -= fit * bytes;
    return fit;
  }

  voted_points_t header_;
  std::size_t point_bytes_;
  std::size_t left_ = 0;
  std::vector<voted_points_t> pages_;
};

void append_points(voted_points_t& page, TileKey key, const PointTile& tile, std::size_t first, std::size_t last,
                   std::span<const VotingField> fields) {
  page.first = static_cast<std::int32_t>(first);
  page.num_points = static_cast<std::int32_t>(last - first);
  for (std::size_t i = first; i < last; ++i) {
    page.x.push_back(tile.points[i].x);
    page.y.push_back(tile.points[i].y);
    page.z.push_back(tile.points[i].z);
    page.intensity.push_back(tile.points[i].intensity);
  }
  for (const VotingField& field : fields) {
    const auto voters = field.voters_of_points(key);
    const auto points = field.points_of_voters(key);
    for (std::size_t i = first; i < last; ++i) page.voter.push_back(static_cast<std::int32_t>(points[voters[i]]));
  }
}

void append_tensor(voted_points_t& page, std::size_t scale, std::uint32_t point, const WireTensor& wire) {
  page.scale.push_back(static_cast<std::uint8_t>(scale));
  page.point.push_back(static_cast<std::int32_t>(point));
  page.normal_x.push_back(wire.normal[0]);
  page.normal_y.push_back(wire.normal[1]);
  page.normal_z.push_back(wire.normal[2]);
  page.tangent_x.push_back(wire.tangent[0]);
  page.tangent_y.push_back(wire.tangent[1]);
  page.tangent_z.push_back(wire.tangent[2]);
  page.stick.push_back(wire.stick);
  page.plate.push_back(wire.plate);
  page.mass.push_back(wire.mass);
}

}  // namespace

std::vector<voted_points_t> make_voted_pages(TileKey key, const PointTile& tile, std::int32_t revision,
                                             const VotedBase& base, std::span<const VotingField> fields) {
  voted_points_t header{};
  header.utime = tile.utime;  // its own points' time, not its neighbours': a fact of the content
  header.tile_x = key.x;
  header.tile_y = key.y;
  header.z_origin = static_cast<float>(tile.z_origin);
  header.base = base.revision;
  header.revision = revision;
  header.total = static_cast<std::int32_t>(tile.points.size());
  header.first = header.total;
  header.num_scales = static_cast<std::int8_t>(fields.size());
  for (const VotingField& field : fields) header.sigma.push_back(static_cast<float>(field.parameters().sigma));
  PageWriter writer(header, fields.size());
  for (std::size_t first = base.num_points; first < tile.points.size();) {
    const std::size_t last = first + writer.room_for_points(tile.points.size() - first);
    append_points(writer.page(), key, tile, first, last, fields);
    first = last;
  }
  for (std::size_t scale = 0; scale < fields.size(); ++scale) {
    const std::int64_t since = base.changes.empty() ? 0 : base.changes[scale];
    const WireTensors wires = tensors_changed(fields[scale], key, since);
    for (std::size_t i = 0; i < wires.points.size();) {
      for (std::size_t fit = writer.room_for_tensors(wires.points.size() - i); fit > 0; --fit, ++i) {
        append_tensor(writer.page(), scale, wires.points[i], wires.tensors[i]);
      }
    }
  }
  return writer.finish();
}

VotedBase make_voted_base(const PointTile& tile, std::int32_t revision, std::span<const VotingField> fields) {
  VotedBase base{revision, tile.points.size(), {}};
  for (const VotingField& field : fields) base.changes.push_back(field.change());
  return base;
}

}  // namespace curbstone
