#pragma once

#include <cstdint>
#include <optional>

#include "services/mapper/registration/registration.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan.hpp"
#include "tools/evaluate/truth/trajectory.hpp"

namespace curbstone::bench::mapping::methods {

/// The content of the final map.
struct MapContent {
  std::int64_t points = 0;          ///< of the published map
  double bytes_per_point = 0;       ///< of the published map, as stored or sent
  double square_metres = 0;         ///< of surface that hold at least one point, seen from above
  std::int64_t local_elements = 0;  ///< voxels or points of the local map that registration keeps
};

/// Interface of a method that estimates the vehicle's poses from revolutions.
class MappingMethod {
 public:
  virtual ~MappingMethod() = default;
  /// T_map_base at the end of the revolution; empty if there is no result.
  [[nodiscard]] virtual std::optional<evaluate::truth::StampedPose> process(
      const mapper::scan::Scan& scan, const mapper::scan::OdometryHistory& odometry) = 0;
  /// The covariance of the last pose of process(), in base_link axes; empty if the method has none.
  [[nodiscard]] virtual std::optional<mapper::registration::Matrix6> covariance() const { return std::nullopt; }
  /// The drive has ended.
  virtual void finish() {}
  [[nodiscard]] virtual MapContent content() const = 0;
  /// How often it corrected earlier poses: loop closures, rolled-back maps.
  [[nodiscard]] virtual int rearranged() const { return 0; }
  /// The drive's poses as now estimated; empty if the method never corrects them.
  [[nodiscard]] virtual evaluate::truth::Trajectory trajectory() const { return {}; }
};

}  // namespace curbstone::bench::mapping::methods
