#pragma once

#include <string>

#include "tools/evaluate/truth/truth.hpp"

namespace curbstone::evaluate::truth {

/// Whether two surfaces meet at a place across which a curb may run.
enum class Border {
  kNone,       ///< the same ground on both sides: a curb there is wrong
  kSomewhere,  ///< they do, but labels are too thin to say where
  kNotKnown,   ///< one side or both have no label
};

/// The curbs and the ground of a recorded street, from the labels of its scans (SemanticKITTI). A curb is where road
/// and sidewalk meet: the midpoints between points of the one and of the other that are each other's nearest, less than
/// 0.3 m apart. Its height is the offset between the two, fitted within 0.6 m together with a slope that both share,
/// and median-smoothed along 0.75 m; gaps up to 0.8 m are bridged. Steps below 4 cm, and other borders that may look
/// like one (road and parking, road and vegetation, sidewalk and vegetation, sidewalk and terrain) are marked
/// `dropped`: neither right nor wrong.
struct StreetLabels {
  std::vector<TrueCurbPoint> curbs;  ///< about one each 0.1 m, each a line of its own
  TrueClasses classes;               ///< road, curb, wall; kLabelledOnly where only that something was labelled counts
  static constexpr std::uint8_t kLabelledOnly = 255;
  TrueClasses surfaces = {};  ///< Surface of each pixel; empty where curbs were clicked
  /// `up_x`, `up_y`: unit vector across the curb.
  [[nodiscard]] Border border_at(double x, double y, double up_x, double up_y) const;
};

/// `folder` holds scans/NNNNNN.bin, labels/NNNNNN.label and reference_poses.txt (3x4 rows, in the lidar frame of scan
/// 0), which `T_world_first` takes to the truth's frame; of one scan alone no poses. labels.csv names other labels
/// (LabelTable). Where there is a curbs.csv it is the truth instead of labels (read_clicked_curbs()). Throws
/// std::runtime_error with one clear line.
[[nodiscard]] StreetLabels read_street_labels(const std::string& folder, const Pose& T_world_first);

}  // namespace curbstone::evaluate::truth
