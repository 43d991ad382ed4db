#include "services/tensor_voting/worker/voted_pages.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/tensor_voting/kernels/decomposition.hpp"

namespace curbstone::tensor_voting::worker {

namespace {

/// A decomposition as the message carries it.
struct WireTensor {
  std::int16_t normal[3];
  std::int8_t tangent[3];
  std::uint8_t stick;
  std::uint8_t plate;
  float mass;
};

WireTensor to_wire(const kernels::DecompositionF& d) {
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

constexpr std::uint64_t kNothingOut = 0;

/// 64 bits that differ where the sums do, but for a chance of 2^-64 (mixing step of MurmurHash3's finaliser, Appleby).
std::uint64_t digest_of(const kernels::VoteSums& sums) {
  std::uint64_t digest = 1;
  for (const std::int64_t value : sums.value) {
    digest = (digest ^ static_cast<std::uint64_t>(value)) * 0xff51afd7ed558ccdULL;
    digest ^= digest >> 33U;
  }
  return digest;
}

/// Of the blocks of voters that votes have reached, those voters whose own sums are others than what is out.
WireTensors take_changed_tensors(const voting::VotingField& field, TileKey key, VotedBase::Scale& out) {
  WireTensors wires;
  const std::vector<std::uint32_t> voters = field.voters_changed(key, out.change);
  const std::vector<kernels::VoteSums> all_sums = field.sums(key, voters);
  const auto points = field.points_of_voters(key);
  out.digests.resize(points.size(), kNothingOut);
  std::vector<kernels::TensorF> tensors;
  for (std::size_t i = 0; i < voters.size(); ++i) {
    const std::uint64_t digest = digest_of(all_sums[i]);
    if (std::exchange(out.digests[voters[i]], digest) == digest) continue;
    wires.points.push_back(points[voters[i]]);
    tensors.push_back(kernels::to_float(kernels::to_tensor(all_sums[i], field.parameters().ball)));
  }
  out.change = field.change();
  wires.tensors.reserve(voters.size());
  for (const kernels::DecompositionF& d : kernels::decompose(tensors)) wires.tensors.push_back(to_wire(d));
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
                   std::span<const voting::VotingField> fields) {
  page.first = static_cast<std::int32_t>(first);
  page.num_points = static_cast<std::int32_t>(last - first);
  for (std::size_t i = first; i < last; ++i) {
    page.x.push_back(tile.points[i].x);
    page.y.push_back(tile.points[i].y);
    page.z.push_back(tile.points[i].z);
    page.intensity.push_back(tile.points[i].intensity);
  }
  for (const voting::VotingField& field : fields) {
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

std::vector<voted_points_t> make_voted_pages(TileKey key, const PointTile& tile, std::int32_t revision, VotedBase& base,
                                             std::span<const voting::VotingField> fields) {
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
  for (const voting::VotingField& field : fields) header.sigma.push_back(static_cast<float>(field.parameters().sigma));
  PageWriter writer(header, fields.size());
  for (std::size_t first = base.num_points; first < tile.points.size();) {
    const std::size_t last = first + writer.room_for_points(tile.points.size() - first);
    append_points(writer.page(), key, tile, first, last, fields);
    first = last;
  }
  base.scales.resize(fields.size());
  for (std::size_t scale = 0; scale < fields.size(); ++scale) {
    const WireTensors wires = take_changed_tensors(fields[scale], key, base.scales[scale]);
    for (std::size_t i = 0; i < wires.points.size();) {
      for (std::size_t fit = writer.room_for_tensors(wires.points.size() - i); fit > 0; --fit, ++i) {
        append_tensor(writer.page(), scale, wires.points[i], wires.tensors[i]);
      }
    }
  }
  base.revision = revision;
  base.num_points = tile.points.size();
  return writer.finish();
}

}  // namespace curbstone::tensor_voting::worker
