#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "tools/simulate/motion/motion.hpp"
#include "tools/simulate/paint/markings.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate::truth {

/// The folder that `curbstone evaluate` reads: truth.json, poses.csv, for towns also classes.png, curbs.csv,
/// markings.csv and, unless the town is large, fine_classes.png. All functions throw std::runtime_error with one clear
/// line when something cannot be written.
struct TruthInfo {
  std::int64_t start_utime = 0;
  std::uint64_t seed = 0;
  std::string source;  ///< "town", or the folder of the scans
  double seconds = 0;
  std::optional<double> latest_packet = std::nullopt;  ///< s, live: how late the latest packet was
};

/// Where the class image lies.
struct ClassImageInfo {
  double resolution = 0;  ///< m a pixel
  double x0 = 0;          ///< m, lower-left corner, world frame
  double y0 = 0;
  int width = 0;
  int height = 0;
  double fine_resolution = 0;  ///< m a pixel, of the finer image with the same corner; 0: there is none
};

/// Makes the folder, and finds out now rather than after the drive whether it can be written.
void prepare_truth_folder(const std::string& folder);
/// classes.png, fine_classes.png, curbs.csv and markings.csv: known before the drive.
ClassImageInfo write_town_truth(const std::string& folder, const world::Town& town,
                                std::span<const paint::Marking> markings, double vehicle_height);
/// poses.csv and truth.json: known when the drive has begun. Without `classes` the truth has none, and says so.
void write_drive_truth(const std::string& folder, const TruthInfo& info, const motion::Motion& motion,
                       const std::optional<ClassImageInfo>& classes);

}  // namespace curbstone::simulate::truth
