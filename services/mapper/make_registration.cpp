#include "services/mapper/make_registration.hpp"

#include "services/mapper/icp_registration.hpp"
#include "services/mapper/loam_registration.hpp"

namespace curbstone {

std::unique_ptr<Registration> make_registration(const MapperConfig& config) {
  const Eigen::Vector3d lidar = config.vehicle.T_base_lidar().translation();
  if (config.method == "loam") return std::make_unique<LoamRegistration>(config.loam, lidar);
  return std::make_unique<IcpRegistration>(config.icp, lidar);
}

}  // namespace curbstone
