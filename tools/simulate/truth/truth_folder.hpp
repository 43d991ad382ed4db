#pragma once

#include <cstdint>
#include <string>

#include "tools/simulate/motion/motion.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone {

/// The folder that `curbstone evaluate` reads: truth.json, poses.csv, and for towns classes.png and curbs.csv. All
/// functions throw std::runtime_error with one clear line when something cannot be written.
struct TruthInfo {
  std::int64_t start_utime = 0;
  std::uint64_t seed = 0;
  std::string source;  ///< "town", or the folder of the scans
  double seconds = 0;
};

/// Makes the folder, and finds out now rather than after the drive whether it can be written.
void prepare_truth_folder(const std::string& folder);
void write_poses(const std::string& folder, const TruthInfo& info, const Motion& motion);
void write_town_truth(const std::string& folder, const TruthInfo& info, const Town& town, double vehicle_height);
/// A drive without class truth.
void write_truth_info(const std::string& folder, const TruthInfo& info);

}  // namespace curbstone
