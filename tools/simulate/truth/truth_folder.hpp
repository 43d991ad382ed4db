#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "tools/simulate/motion/motion.hpp"
#include "tools/simulate/paint/markings.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate::truth {

/// The folder that `curbstone evaluate` reads: truth.json, poses.csv; for towns also classes.png, curbs.csv,
/// markings.csv and, unless the town is large, fine_classes.png. All functions throw std::runtime_error with a one-line
/// message if something cannot be written.
struct TruthInfo {
  std::int64_t start_utime = 0;
  std::uint64_t seed = 0;
  std::string source;  ///< "town", or the folder of the scans
  double seconds = 0;
  std::optional<double> latest_packet = std::nullopt;  ///< s, live: largest delay of a packet
};

/// The position and size of the class image.
struct ClassImageInfo {
  double resolution = 0;  ///< m per pixel
  double x0 = 0;          ///< m, lower-left corner, world frame
  double y0 = 0;
  int width = 0;
  int height = 0;
  double fine_resolution = 0;  ///< m per pixel, of the finer image with the same corner; 0: there is none
};

/// Creates the folder, and checks before the drive that it can be written.
void prepare_truth_folder(const std::string& folder);
/// Writes classes.png, fine_classes.png, curbs.csv and markings.csv, which are known before the drive.
ClassImageInfo write_town_truth(const std::string& folder, const world::Town& town,
                                std::span<const paint::Marking> markings, double vehicle_height);
/// Writes poses.csv and truth.json, which are known once the drive has begun. Without `classes` the truth has none, and
/// truth.json says so.
void write_drive_truth(const std::string& folder, const TruthInfo& info, const motion::Motion& motion,
                       const std::optional<ClassImageInfo>& classes);

}  // namespace curbstone::simulate::truth
