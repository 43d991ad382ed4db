#pragma once

#include <memory>
#include <optional>

#include "common/config/vehicle.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/deskew.hpp"
#include "tools/bench/mapping/methods/mapping_method.hpp"

namespace curbstone::bench::mapping::methods {

/// A PCL registration against a local map, as a user would assemble it: de-skew and initial guess by odometry or
/// constant motion, source and map thinned by VoxelGrid, the map cropped to its surroundings and passed to PCL again
/// after each metre.
class PclMethod final : public MappingMethod {
 public:
  enum class Kind { kIcp, kGicp, kNdt };
  PclMethod(Kind kind, const VehicleConfig& vehicle);
  ~PclMethod() override;

  [[nodiscard]] std::optional<evaluate::truth::StampedPose> process(
      const mapper::scan::Scan& scan, const mapper::scan::OdometryHistory& odometry) override;
  [[nodiscard]] MapContent content() const override;

 private:
  struct Parts;  // PCL's types
  std::unique_ptr<Parts> parts_;
  Pose T_base_lidar_;
  std::optional<evaluate::truth::StampedPose> last_;
  Pose T_map_insertion_ = Pose::Identity();
  mapper::scan::Twist twist_;
};

}  // namespace curbstone::bench::mapping::methods
