#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace curbstone {

/// The curbs of a real street, from the labels of its scans (SemanticKITTI), by the recipe at the end of
/// ../shared/reference/curbs_on_real_scans.md: midpoints between road and sidewalk points, the step between the two
/// sides measured on the points.
struct TruthPoint {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< m, frame of scan 0
  double step = 0;                               ///< m
  bool counts = true;  ///< road|sidewalk with a step of 4 cm or more; else a detection here is neither right nor wrong
};

struct StreetTruth {
  std::vector<TruthPoint> points;         ///< about one each 0.1 m
  std::vector<Eigen::Vector2d> labelled;  ///< where ground is labelled, 0.25 m grid centres
  [[nodiscard]] bool is_labelled_around(const Eigen::Vector2d& p) const;
};

/// Scans as they lie in a data folder: scans/NNNNNN.bin, labels/NNNNNN.label, reference_poses.txt.
[[nodiscard]] std::vector<Eigen::Vector3f> read_scan(const std::filesystem::path& file);
[[nodiscard]] std::vector<Eigen::Isometry3d> read_poses(const std::filesystem::path& file);
[[nodiscard]] StreetTruth make_street_truth(const std::filesystem::path& folder);

struct StreetScore {
  int truth = 0, found = 0;  ///< of truth points that count, within range
  int detections = 0, right = 0, dont_care = 0;
  double precision = 0, recall = 0, f1 = 0;
  double bias = 0, spread = 0;    ///< m, lateral: signed towards the higher side; robust
  double recall_by_step[5] = {};  ///< < 1.5, 1.5-3, 3-4, 4-5, > 5 cm (all road|sidewalk truth)
};
struct Detection {
  Eigen::Vector2d at, up;
};
[[nodiscard]] StreetScore score_street(const std::vector<Detection>& detections, const StreetTruth& truth,
                                       double tolerance, double range);

}  // namespace curbstone
