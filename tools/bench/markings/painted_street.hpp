#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/bench/markings/marking_score.hpp"

namespace curbstone::bench::markings {

/// A recorded street's scans in one frame.
struct PaintedStreet {
  std::string name;
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint8_t> raw;      ///< intensities as recorded
  std::vector<std::uint8_t> by_ring;  ///< on the scale that the mapper learns of them
};

/// SemanticKITTI's, of `folder` (scans/, labels/, reference_poses.txt): all lasers of all scans; four times one laser
/// in four. Throws std::runtime_error with one clear line.
[[nodiscard]] std::vector<PaintedStreet> read_painted_streets(const std::string& folder);

/// What is labelled as lane marking (class 60) within 15 m of a labelled scan, and where anything on the ground is
/// labelled at all: elsewhere nothing is judged.
[[nodiscard]] PaintTruth read_street_paint(const std::string& folder);

}  // namespace curbstone::bench::markings
