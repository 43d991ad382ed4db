#pragma once

#include <cstdint>
#include <optional>

#include "services/mapper/registration/registration.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan.hpp"
#include "tools/evaluate/truth/trajectory.hpp"

namespace curbstone::bench::mapping::methods {

/// What a map is made of, in the end.
struct MapContent {
  std::int64_t points = 0;          ///< of the map that is for others
  double bytes_per_point = 0;       ///< of it, as it is stored or sent
  double square_metres = 0;         ///< of ground or other surface seen from above that hold at least one point
  std::int64_t local_elements = 0;  ///< voxels or points of the map that registration itself keeps
};

/// Something that finds the vehicle's poses from revolutions.
class MappingMethod {
 public:
  virtual ~MappingMethod() = default;
  /// T_map_base at the end of the revolution; nothing if it gives none.
  [[nodiscard]] virtual std::optional<evaluate::truth::StampedPose> process(
      const mapper::scan::Scan& scan, const mapper::scan::OdometryHistory& odometry) = 0;
  /// What it claims to know of the pose that process() gave last, in base_link axes; nothing if it claims nothing.
  [[nodiscard]] virtual std::optional<mapper::registration::Matrix6> covariance() const { return std::nullopt; }
  /// The drive is over.
  virtual void finish() {}
  [[nodiscard]] virtual MapContent content() const = 0;
  /// How often it has put right what it had said before: loops closed, maps rolled back.
  [[nodiscard]] virtual int rearranged() const { return 0; }
  /// The drive's poses as the method has them now; empty if it never changes what it has said.
  [[nodiscard]] virtual evaluate::truth::Trajectory trajectory() const { return {}; }
};

}  // namespace curbstone::bench::mapping::methods
