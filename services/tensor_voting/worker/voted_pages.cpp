#include "services/tensor_voting/worker/voted_pages.hpp"

#include <algorithm>
#include <bit>
#include <iterator>
#include <utility>

#include "common/tiles/vector_memory.hpp"
#include "services/tensor_voting/kernels/tensor_block.hpp"

namespace curbstone::tensor_voting::worker {

namespace {

/// Decompositions in the representation of the message, side by side.
struct WireBlock {
  std::int16_t normal[3][kernels::kLanes];
  std::int8_t tangent[3][kernels::kLanes];
  std::uint8_t stick[kernels::kLanes];
  std::uint8_t plate[kernels::kLanes];
  float mass[kernels::kLanes];
};

/// Rounds to the nearest integer, halves away from 0, as std::lround() does; |v| < 2^23.
template <class Whole>
void round_to(Whole* to, const float* from, float factor) {
  for (std::size_t lane = 0; lane < kernels::kLanes; ++lane) {
    const float v = from[lane] * factor;
    const auto whole = static_cast<std::int32_t>(v);
    const float rest = v - static_cast<float>(whole);
    to[lane] = static_cast<Whole>(whole + (rest >= 0.5F ? 1 : 0) - (rest <= -0.5F ? 1 : 0));
  }
}

WireBlock to_wire(const kernels::ShapeBlock& shapes, const kernels::TensorBlock& tensors) {
  WireBlock wire;
  const auto component = [&](std::size_t c) { return shapes.component + c * kernels::kLanes; };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    round_to(wire.normal[axis], component(axis), 32767);
    round_to(wire.tangent[axis], component(3 + axis), 127);
  }
  round_to(wire.stick, component(6), 255);
  round_to(wire.plate, component(7), 255);
  std::copy(std::begin(tensors.mass), std::end(tensors.mass), wire.mass);
  return wire;
}

/// The tensors of one scale to be sent, in the order of the points; kLanes to a block.
struct WireTensors {
  std::vector<std::uint32_t> points;  // indices in the tile
  std::vector<WireBlock> blocks;
};

/// Collects voters and their sums block by block, and returns them in the order of the voters.
class VotersInOrder {
 public:
  explicit VotersInOrder(std::size_t num_voters) : found_(num_voters / 64 + 1), at_(num_voters) {}

  void add(std::uint32_t voter, const kernels::VoteSums& sums) {
    found_[voter / 64] |= std::uint64_t{1} << (voter % 64);
    at_[voter] = static_cast<std::uint32_t>(sums_.size());
    sums_.push_back(sums);
  }
  [[nodiscard]] std::size_t size() const { return sums_.size(); }
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t word = 0; word < found_.size(); ++word) {
      for (std::uint64_t rest = found_[word]; rest != 0; rest &= rest - 1) {
        const auto voter = static_cast<std::uint32_t>(word * 64 + static_cast<unsigned>(std::countr_zero(rest)));
        visit(voter, sums_[at_[voter]]);
      }
    }
  }

 private:
  std::vector<std::uint64_t> found_;  // one bit for each voter
  std::vector<std::uint32_t> at_;
  std::vector<kernels::VoteSums> sums_;
};

constexpr std::uint64_t kNothingOut = 0;

/// A digest of 64 bits: different sums have the same digest with probability 2^-64 (mixing step of MurmurHash3's
/// finaliser, Appleby).
std::uint64_t digest_of(const kernels::VoteSums& sums) {
  std::uint64_t digest = 1;
  for (const std::int64_t value : sums.value) {
    digest = (digest ^ static_cast<std::uint64_t>(value)) * 0xff51afd7ed558ccdULL;
    digest ^= digest >> 33U;
  }
  return digest;
}

/// Finds, in the blocks that have received votes, the voters whose sums differ from the published ones.
VotersInOrder take_changed_voters(const voting::VotingField& field, TileKey key, VotedBase::Scale& out) {
  VotersInOrder changed(field.num_voters(key));
  field.for_each_changed(key, out.change, [&](const voting::ReceivedBlock& received) {
    if (out.digests.size() <= received.number) {
      make_room(received.number + 1 - out.digests.size(), out.digests);
      out.digests.resize(received.number + 1, {kNothingOut});
    }
    auto& digests = out.digests[received.number];
    for (std::size_t lane = 0; lane < received.voters.size(); ++lane) {
      const kernels::VoteSums sums = received.of(lane);
      const std::uint64_t digest = digest_of(sums);
      if (std::exchange(digests[lane], digest) != digest) changed.add(received.voters[lane], sums);
    }
  });
  out.change = field.change();
  return changed;
}

WireTensors take_changed_tensors(const voting::VotingField& field, TileKey key, VotedBase::Scale& out) {
  const VotersInOrder changed = take_changed_voters(field, key, out);
  const auto points = field.points_of_voters(key);
  std::vector<kernels::TensorBlock> tensors((changed.size() + kernels::kLanes - 1) / kernels::kLanes);
  WireTensors wires;
  wires.points.reserve(changed.size());
  changed.for_each([&](std::uint32_t voter, const kernels::VoteSums& sums) {
    const std::size_t i = wires.points.size();
    wires.points.push_back(points[voter]);
    tensors[i / kernels::kLanes].set(i % kernels::kLanes,
                                     kernels::to_float(kernels::to_tensor(sums, field.parameters().ball)));
  });
  std::vector<kernels::ShapeBlock> shapes(tensors.size());
  kernels::decompose(tensors, shapes);
  wires.blocks.reserve(tensors.size());
  for (std::size_t i = 0; i < tensors.size(); ++i) wires.blocks.push_back(to_wire(shapes[i], tensors[i]));
  return wires;
}

/// Fills pages one after the other.
class PageWriter {
 public:
  PageWriter(voted_points_t header, std::size_t num_scales)
      : header_(std::move(header)), point_bytes_(7 + 4 * num_scales) {
    begin_page();
  }

  /// Takes as many points as still fit into the page. Returns how many of `count`, at least one.
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

void append_tensors(voted_points_t& page, std::size_t scale, const WireTensors& wires, std::size_t first,
                    std::size_t last) {
  page.scale.resize(page.scale.size() + last - first, static_cast<std::uint8_t>(scale));
  const auto at = [&](std::size_t i) { return wires.points.begin() + static_cast<std::ptrdiff_t>(i); };
  page.point.insert(page.point.end(), at(first), at(last));
  const auto fill = [&](auto& field, auto of) {
    for (std::size_t i = first, count = 0; i < last; i += count) {
      const auto* const lanes = of(wires.blocks[i / kernels::kLanes]);
      count = std::min(kernels::kLanes - i % kernels::kLanes, last - i);
      field.insert(field.end(), lanes + i % kernels::kLanes, lanes + i % kernels::kLanes + count);
    }
  };
  fill(page.normal_x, [](const WireBlock& b) { return b.normal[0]; });
  fill(page.normal_y, [](const WireBlock& b) { return b.normal[1]; });
  fill(page.normal_z, [](const WireBlock& b) { return b.normal[2]; });
  fill(page.tangent_x, [](const WireBlock& b) { return b.tangent[0]; });
  fill(page.tangent_y, [](const WireBlock& b) { return b.tangent[1]; });
  fill(page.tangent_z, [](const WireBlock& b) { return b.tangent[2]; });
  fill(page.stick, [](const WireBlock& b) { return b.stick; });
  fill(page.plate, [](const WireBlock& b) { return b.plate; });
  fill(page.mass, [](const WireBlock& b) { return b.mass; });
}

}  // namespace

std::vector<voted_points_t> make_voted_pages(TileKey key, const PointTile& tile, std::int32_t revision, VotedBase& base,
                                             std::span<const voting::VotingField> fields) {
  voted_points_t header{};
  header.utime = tile.utime;  // the time of its own points, not its neighbours': it depends on the content alone
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
    for (std::size_t first = 0; first < wires.points.size();) {
      const std::size_t last = first + writer.room_for_tensors(wires.points.size() - first);
      append_tensors(writer.page(), scale, wires, first, last);
      first = last;
    }
  }
  base.revision = revision;
  base.num_points = tile.points.size();
  return writer.finish();
}

}  // namespace curbstone::tensor_voting::worker
