#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/bench/markings/marking_score.hpp"

namespace curbstone::bench::markings {

/// The scans of a recorded street in one frame.
struct PaintedStreet {
  std::string name;
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint8_t> raw;      ///< intensities as recorded
  std::vector<std::uint8_t> by_ring;  ///< on the scale that the mapper learns from them
};

/// Reads SemanticKITTI scans from `folder` (scans/, labels/, reference_poses.txt): once with all lasers of all scans,
/// and four times with one laser in four. Throws std::runtime_error with a one-line message.
[[nodiscard]] std::vector<PaintedStreet> read_painted_streets(const std::string& folder);

/// Cells labelled as lane marking (class 60) within 15 m of a labelled scan. Only cells with any label on the ground
/// are judged.
[[nodiscard]] PaintTruth read_street_paint(const std::string& folder);

}  // namespace curbstone::bench::markings
