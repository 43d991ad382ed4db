#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "services/mapper/scan/keyframe.hpp"

namespace curbstone::mapper::place_recognition {

/// A node that looks like the scan that was asked about.
struct PlaceCandidate {
  int node = 0;
  double yaw = 0;       ///< rad: of the scan's base_link in the node's, to half a sector
  double distance = 0;  ///< 0 (the same) .. 1
};

/// Which nodes look like a scan, from whatever heading: how high things stand, by distance and direction (Scan Context:
/// Kim, Kim, IROS 2018). Heights above the ground that the scan itself shows; what the rays miss counts as ground.
/// Nodes are ranked by all of it, after a sieve by what does not change with the heading. A scan is also tried as if
/// taken from a lane to the left or right (Kim, Choi, Kim, T-RO 2021, section IV-C). 1.3 kB a node. Pure; one thread;
/// deterministic.
class ScanContext {
 public:
  /// Points in base_link, about level.
  void add(int node, const std::vector<scan::KeyframePoint>& points);
  void clear() { entries_.clear(); }
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

  /// The `most` likeliest nodes and headings, best first; of equals the one added first. A node comes twice, with
  /// headings far apart, where it looks alike both ways: streets do.
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
  /// At the best turn, and at the best that is a right angle or more from it.
  [[nodiscard]] static std::array<Match, 2> compare(const Heights& scan, const Heights& node);

  [[nodiscard]] std::vector<std::size_t> alike(const RingKey& key) const;

  std::vector<Entry> entries_;
};

}  // namespace curbstone::mapper::place_recognition
