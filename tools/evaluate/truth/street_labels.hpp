#pragma once

#include <string>

#include "tools/evaluate/truth/truth.hpp"

namespace curbstone::evaluate::truth {

/// Whether two surfaces meet at a place across which a curb may run.
enum class Border {
  kNone,       ///< the same surface on both sides: a curb there is wrong
  kSomewhere,  ///< two surfaces meet, but the labels are too sparse to locate the border
  kNotKnown,   ///< at least one side has no label
};

/// The curbs and the ground of a recorded street, from the labels of its scans (SemanticKITTI). A curb is where road
/// and sidewalk meet: the midpoints between mutually nearest points of the two, less than 0.3 m apart. Its height is
/// the offset between the two, fitted within 0.6 m together with a common slope, and median-smoothed along 0.75 m; gaps
/// up to 0.8 m are bridged. Steps below 4 cm, and other borders that may look like a curb (road and parking, road and
/// vegetation, sidewalk and vegetation, sidewalk and terrain), are marked `dropped`: neither right nor wrong.
struct StreetLabels {
  std::vector<TrueCurbPoint> curbs;  ///< about one per 0.1 m, each a line of its own
  TrueClasses classes;               ///< road, curb, wall; kLabelledOnly for ground with any other label
  static constexpr std::uint8_t kLabelledOnly = 255;
  TrueClasses surfaces = {};  ///< Surface of each pixel; empty for clicked curbs
  /// `up_x`, `up_y`: unit vector across the curb.
  [[nodiscard]] Border border_at(double x, double y, double up_x, double up_y) const;
};

/// Reads `folder` with scans/NNNNNN.bin, labels/NNNNNN.label and reference_poses.txt (3x4 rows, in the lidar frame of
/// scan 0), which `T_world_first` transforms to the truth's frame. A single scan needs no poses. labels.csv names other
/// labels (LabelTable). If there is a curbs.csv it is the truth instead of the labels (read_clicked_curbs()). Throws
/// std::runtime_error with a one-line message.
[[nodiscard]] StreetLabels read_street_labels(const std::string& folder, const Pose& T_world_first);

}  // namespace curbstone::evaluate::truth
