#include "services/mapper/journal/journal_codec.hpp"

#include <algorithm>
#include <stdexcept>
#include <unordered_set>
#include <utility>

#include "services/mapper/journal/batch_bytes.hpp"

namespace curbstone::mapper::journal {
namespace {

enum class Item : std::uint8_t { kHead = 1, kNode, kEdge, kPose, kTile, kEviction, kRings, kEpoch };

template <class Value>
void put(std::string& out, const Value& value) {
  append_value(out, value);
}

void put(std::string& out, const Pose& pose) {
  for (int i = 0; i < 12; ++i) put(out, pose.matrix()(i / 4, i % 4));
}

void put(std::string& out, const TilePoint& p) {
  put(out, p.x);
  put(out, p.y);
  put(out, p.z);
  put(out, p.intensity);
}

void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
}

constexpr double kMapReach = 50'000;                       // m: what a voxel's key can name is little more
constexpr double kOdomReach = 1e7;                         // m: odometry drifts
constexpr std::int32_t kMaxKey = 17'000;                   // of a tile: 51 km
constexpr std::int32_t kMaxOrigin = 32'700;                // m
constexpr std::int64_t kMaxUtime = std::int64_t{1} << 60;  // us

/// Reads the items of a batch from left to right.
class ItemBytes : public BatchBytes {
 public:
  using BatchBytes::BatchBytes;
  /// `reach`: m from the origin, at most.
  [[nodiscard]] Pose take_pose(double reach) {
    Pose pose = Pose::Identity();
    for (int i = 0; i < 12; ++i) pose.matrix()(i / 4, i % 4) = take<double>();
    const Eigen::Matrix3d R = pose.linear();
    const bool is_rotation = (R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-3 && R.determinant() > 0;
    const bool is_there = pose.translation().cwiseAbs().maxCoeff() <= reach;
    require(is_finite(pose) && is_rotation && is_there, "holds a pose that no vehicle has");
    return pose;
  }
  [[nodiscard]] TileKey take_key() {
    const auto x = take<std::int32_t>();
    const auto y = take<std::int32_t>();
    const auto is_there = [](std::int32_t v) { return v >= -kMaxKey && v <= kMaxKey; };
    require(is_there(x) && is_there(y), "holds a tile that no vehicle comes to");
    return {x, y};
  }
  /// A count of items that follow, of `size` bytes each.
  [[nodiscard]] std::size_t take_count(std::size_t size) {
    const auto count = take<std::uint32_t>();
    require(count <= this->size() / size, "claims more than it holds");
    return count;
  }
};

constexpr std::size_t kNodePointBytes = 6;
constexpr std::size_t kRecordBytes = 7;
constexpr std::size_t kRunBytes = 16;

RecordedNode take_node(ItemBytes& bytes) {
  RecordedNode node;
  node.kept.utime = bytes.take<std::int64_t>();
  node.kept.T_map_base = bytes.take_pose(kMapReach);
  node.driven = bytes.take<double>();
  require(node.driven >= 0 && node.driven < kOdomReach, "holds a drive of no length");
  std::vector<scan::KeyframePoint> points(bytes.take_count(kNodePointBytes));
  for (scan::KeyframePoint& p : points) {
    p.x = bytes.take<std::int16_t>();
    p.y = bytes.take<std::int16_t>();
    p.z = bytes.take<std::int16_t>();
  }
  node.kept.points = std::move(points);
  return node;
}

pose_graph::PoseEdge take_edge(ItemBytes& bytes) {
  pose_graph::PoseEdge edge;
  edge.from = bytes.take<std::int32_t>();
  edge.to = bytes.take<std::int32_t>();
  edge.closes_loop = bytes.take<std::uint8_t>() != 0;
  edge.T_from_to = bytes.take_pose(kMapReach);
  for (int i = 0; i < 36; ++i) edge.information(i / 6, i % 6) = bytes.take<double>();
  return edge;
}

RecordedPose take_pose(ItemBytes& bytes) {
  RecordedPose pose;
  pose.utime = bytes.take<std::int64_t>();
  pose.revolution = bytes.take<std::int32_t>();
  pose.node = bytes.take<std::int32_t>();
  require(pose.utime >= 0 && pose.utime <= kMaxUtime, "holds a pose of no time");
  pose.T_map_base = bytes.take_pose(kMapReach);
  pose.T_map_odom = bytes.take_pose(kOdomReach);
  pose.with_odometry = bytes.take<std::uint8_t>() != 0;
  pose.standing_since = bytes.take<std::int64_t>();
  pose.has_moved = bytes.take<std::uint8_t>() != 0;
  return pose;
}

void take_tile(ItemBytes& bytes, RecordedDrive& drive, std::size_t batch) {
  const TileKey key = bytes.take_key();
  RecordedTile& tile = drive.tiles[key];
  tile.touched = batch;
  if (!tile.spilled.empty()) tile.content = std::exchange(tile.spilled, {}).read();
  tile.z_origin = bytes.take<std::int32_t>();
  require(tile.z_origin >= -kMaxOrigin && tile.z_origin <= kMaxOrigin, "holds a tile of no height");
  require(bytes.take<std::uint32_t>() == tile.content.records.size(), "leaves out records of a tile");
  const std::size_t records = bytes.take_count(kRecordBytes);
  for (std::size_t i = 0; i < records; ++i) {
    TilePoint p;
    p.x = bytes.take<std::int16_t>();
    p.y = bytes.take<std::int16_t>();
    p.z = bytes.take<std::int16_t>();
    p.intensity = bytes.take<std::uint8_t>();
    tile.content.records.push_back(p);
  }
  const std::size_t runs = bytes.take_count(kRunBytes);
  for (std::size_t i = 0; i < runs; ++i) {
    dense_map::TileRecords::Run run{};
    run.anchor = bytes.take<std::int32_t>();
    run.first = bytes.take<std::int32_t>();
    run.utime = bytes.take<std::int64_t>();
    tile.content.runs.push_back(run);
  }
  tile.num_records = tile.content.records.size();
  tile.num_runs = tile.content.runs.size();
}

intensity::RingHistograms take_rings(ItemBytes& bytes) {
  using Rings = intensity::RingHistograms;
  Rings rings;
  rings.scans = bytes.take<std::int32_t>();
  const std::size_t count = bytes.take_count(sizeof(Rings::Counts));
  require(rings.scans >= 0 && count <= Rings::kMaxRings, "holds more rings than a LiDAR has");
  for (std::size_t i = 0; i < count; ++i) {
    rings.rings.push_back(bytes.take<Rings::Counts>());
    for (const std::uint32_t returns : rings.rings.back())
      require(returns <= Rings::kMaxReturns, "holds more returns of a ring than can be");
  }
  return rings;
}

/// Checks that each removal refers to an existing point.
void check_removals(const std::vector<TilePoint>& records) {
  if (std::none_of(records.begin(), records.end(), is_removal)) return;
  std::unordered_set<std::uint64_t> there;
  const auto place = [](const TilePoint& p) {
    return std::uint64_t{static_cast<std::uint16_t>(p.x)} << 32 | std::uint64_t{static_cast<std::uint16_t>(p.y)} << 16 |
           static_cast<std::uint16_t>(p.z);
  };
  for (const TilePoint& record : records) {
    if (is_removal(record))
      require(there.erase(place(removal_of(record))) == 1, "takes out a point that is not there");
    else
      there.insert(place(record));
  }
}

void check_tile(const dense_map::TileRecords& tile, std::int32_t num_nodes) {
  for (const TilePoint& record : tile.records) {
    const TilePoint point = is_removal(record) ? removal_of(record) : record;
    require(point.x >= 0 && point.x < kStepsPerTile && point.y >= 0 && point.y < kStepsPerTile,
            "holds a point outside its tile");
  }
  check_removals(tile.records);
  require(!tile.runs.empty() && tile.runs.front().first == 0, "holds points that nobody made");
  for (std::size_t i = 0; i < tile.runs.size(); ++i) {
    const dense_map::TileRecords::Run& run = tile.runs[i];
    require(run.anchor >= -1 && run.anchor < num_nodes, "holds points of a keyframe that is not there");
    const bool in_order = i == 0 || run.first > tile.runs[i - 1].first;
    require(in_order && static_cast<std::size_t>(run.first) < tile.records.size(), "holds runs out of order");
  }
}

}  // namespace

void append_head(std::string& out, const std::string& config_hash, std::int32_t epoch, std::int32_t num_known) {
  put(out, Item::kHead);
  put(out, static_cast<std::uint32_t>(config_hash.size()));
  out += config_hash;
  put(out, epoch);
  put(out, num_known);
}

void append_epoch(std::string& out, std::int32_t epoch, std::int64_t until) {
  put(out, Item::kEpoch);
  put(out, epoch);
  put(out, until);
}

void append_node(std::string& out, const scan::Keyframe& node, double driven) {
  put(out, Item::kNode);
  put(out, node.utime);
  put(out, node.T_map_base);
  put(out, driven);
  const auto points = node.points.read();
  put(out, static_cast<std::uint32_t>(points->size()));
  for (const scan::KeyframePoint& p : *points) {
    put(out, p.x);
    put(out, p.y);
    put(out, p.z);
  }
}

void append_edge(std::string& out, const pose_graph::PoseEdge& edge) {
  put(out, Item::kEdge);
  put(out, static_cast<std::int32_t>(edge.from));
  put(out, static_cast<std::int32_t>(edge.to));
  put(out, static_cast<std::uint8_t>(edge.closes_loop));
  put(out, edge.T_from_to);
  for (int i = 0; i < 36; ++i) put(out, edge.information(i / 6, i % 6));
}

void append_pose(std::string& out, const RecordedPose& pose) {
  put(out, Item::kPose);
  put(out, pose.utime);
  put(out, pose.revolution);
  put(out, pose.node);
  put(out, pose.T_map_base);
  put(out, pose.T_map_odom);
  put(out, static_cast<std::uint8_t>(pose.with_odometry));
  put(out, pose.standing_since);
  put(out, static_cast<std::uint8_t>(pose.has_moved));
}

void append_tile(std::string& out, TileKey key, std::int32_t z_origin, const dense_map::TileRecords& tile,
                 std::size_t records, std::size_t runs) {
  put(out, Item::kTile);
  put(out, key.x);
  put(out, key.y);
  put(out, z_origin);
  put(out, static_cast<std::uint32_t>(records));
  put(out, static_cast<std::uint32_t>(tile.records.size() - records));
  for (std::size_t i = records; i < tile.records.size(); ++i) put(out, tile.records[i]);
  put(out, static_cast<std::uint32_t>(tile.runs.size() - runs));
  for (std::size_t i = runs; i < tile.runs.size(); ++i) {
    put(out, tile.runs[i].anchor);
    put(out, tile.runs[i].first);
    put(out, tile.runs[i].utime);
  }
}

void append_eviction(std::string& out, TileKey key) {
  put(out, Item::kEviction);
  put(out, key.x);
  put(out, key.y);
}

void append_rings(std::string& out, const intensity::RingHistograms& rings) {
  put(out, Item::kRings);
  put(out, rings.scans);
  put(out, static_cast<std::uint32_t>(rings.rings.size()));
  for (const auto& counts : rings.rings) put(out, counts);
}

void apply_items(std::string_view items, RecordedDrive& drive, std::size_t batch) {
  ItemBytes bytes(items);
  while (!bytes.empty()) {
    const auto item = bytes.take<Item>();
    require((item == Item::kHead) == (drive.epoch == 0), "has no head, or two");
    switch (item) {
      case Item::kHead:
        drive.config_hash = bytes.take_bytes(bytes.take_count(1));
        drive.epoch = bytes.take<std::int32_t>();
        drive.num_known = bytes.take<std::int32_t>();
        require(drive.epoch > 0, "has no epoch");
        break;
      case Item::kEpoch: {
        const auto epoch = bytes.take<std::int32_t>();
        require(epoch > drive.epoch, "goes back to an earlier epoch");
        drive.epoch = epoch;
        drop_poses_after(bytes.take<std::int64_t>(), drive.poses);
        break;
      }
      case Item::kNode:
        drive.nodes.push_back(take_node(bytes));
        break;
      case Item::kEdge:
        drive.edges.push_back(take_edge(bytes));
        break;
      case Item::kPose:
        drive.poses.push_back(take_pose(bytes));
        break;
      case Item::kTile:
        take_tile(bytes, drive, batch);
        break;
      case Item::kEviction:
        drive.tiles.erase(bytes.take_key());
        break;
      case Item::kRings:
        drive.rings = take_rings(bytes);
        break;
      default:
        require(false, "holds an item of no kind that is known");
    }
  }
}

void check_drive(const RecordedDrive& drive) {
  require(drive.epoch > 0, "has no head");
  const auto num_nodes = static_cast<std::int32_t>(drive.nodes.size());
  require(drive.num_known >= 0 && drive.num_known <= num_nodes, "knows more keyframes than it holds");
  require(!drive.poses.empty(), "holds no pose");
  for (const RecordedPose& pose : drive.poses)
    require(pose.node >= 0 && pose.node < num_nodes, "holds a pose at a keyframe that is not there");
  for (const pose_graph::PoseEdge& edge : drive.edges) {
    require(edge.from >= 0 && edge.from < num_nodes && edge.to >= 0 && edge.to < num_nodes && edge.from != edge.to,
            "holds an edge to nowhere");
    require(edge.information.allFinite(), "holds an edge that is not finite");
  }
  for (const auto& [key, tile] : drive.tiles)
    check_tile(tile.spilled.empty() ? tile.content : tile.spilled.read(), num_nodes);
}

}  // namespace curbstone::mapper::journal
