#pragma once

#include <optional>
#include <string>

#include "tools/bench/sensor_faults/catalogue/fault.hpp"
#include "tools/bench/sensor_faults/witness.hpp"
#include "tools/evaluate/truth/truth.hpp"
#include "tools/recording/recorded_config.hpp"

namespace curbstone::bench::sensor_faults {

/// A drive without faults, with its truth.
struct TrueDrive {
  std::string log;
  evaluate::truth::Truth truth;
  recording::RecordedConfig recorded;  ///< what the log was recorded with; empty: the defaults

  /// Reads the truth's folder and the head of the log. Throws std::runtime_error.
  TrueDrive(std::string log_file, const std::string& truth_folder);
};

/// The figures of a map, as `curbstone evaluate` has them.
struct MapFigures {
  double precision = 0, recall = 0, f1 = 0;  ///< of the curbs, at 0.24 m
  double class_accuracy = 0;
  double ate = 0;  ///< m
};

/// What came of a replay.
struct Outcome {
  std::optional<MapFigures> map{};
  std::string failure{};  ///< why there is no map that can be compared
  Witness witness{};
};

/// Makes the map of the drive with a fault in it, as `curbstone replay` does in one thread, in a file of its own in
/// `folder`, and compares it with the truth.
[[nodiscard]] Outcome try_fault(const TrueDrive& drive, const catalogue::Fault& fault, const std::string& folder);

}  // namespace curbstone::bench::sensor_faults
