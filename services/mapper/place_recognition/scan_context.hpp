#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "services/mapper/scan/keyframe.hpp"

namespace curbstone::mapper::place_recognition {

/// A node that looks like the scan.
struct PlaceCandidate {
  int node = 0;
  double yaw = 0;       ///< rad: of the scan's base_link in the node's, accurate to half a sector
  double distance = 0;  ///< 0 (the same) .. 1
};

/// Finds the nodes that look like a scan, from any heading, by the height of objects per distance and direction (Scan
/// Context: Kim, Kim, IROS 2018). Heights are above the ground of the scan itself; cells without returns count as
/// ground. Nodes are preselected by the heading-invariant ring key, then ranked by the full descriptor. A scan is also
/// tried as if taken from a lane to the left or right (Kim, Choi, Kim, T-RO 2021, section IV-C). 1.3 kB a node. Pure;
/// one thread; deterministic.
class ScanContext {
 public:
  /// Adds a node; points in base_link, approximately level.
  void add(int node, const std::vector<scan::KeyframePoint>& points);
  void clear() { entries_.clear(); }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

  /// The `most` most similar nodes with headings, best first; of equal ones the one added first. A node that looks
  /// alike in opposite directions, as streets do, is returned twice, with headings far apart.
  [[nodiscard]] std::vector<PlaceCandidate> query(const std::vector<scan::KeyframePoint>& points, int most) const;

 private:
  static constexpr int kRings = 20, kSectors = 60;
  using Heights = std::array<std::uint8_t, static_cast<std::size_t>(kRings* kSectors)>;  // sector by sector
  using RingKey = std::array<float, kRings>;                                             // mean height, by distance
  struct Entry {
    int node;
    Heights heights;
    RingKey key;
  };
  struct Match {
    float distance = 2;
    int turn = 0;  // sectors
  };

  [[nodiscard]] static Heights heights_of(const std::vector<scan::KeyframePoint>& points, float to_left);
  [[nodiscard]] static RingKey key_of(const Heights& heights);
  /// The best match, and the best one at least a right angle from it.
  [[nodiscard]] static std::array<Match, 2> compare(const Heights& scan, const Heights& node);

  [[nodiscard]] std::vector<std::size_t> alike(const RingKey& key) const;

  std::vector<Entry> entries_;
};

}  // namespace curbstone::mapper::place_recognition
