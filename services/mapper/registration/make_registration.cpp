#include "services/mapper/registration/make_registration.hpp"

#include "services/mapper/registration/icp_registration.hpp"
#include "services/mapper/registration/loam_registration.hpp"

namespace curbstone::mapper::registration {

std::unique_ptr<Registration> make_registration(const config::RegistrationConfig& config,
                                                const Eigen::Vector3d& lidar) {
  switch (config.method) {
    case config::RegistrationMethod::kLoam:
      return std::make_unique<LoamRegistration>(config.loam, lidar);
    case config::RegistrationMethod::kIcp:
      break;
  }
  return std::make_unique<IcpRegistration>(config.icp, lidar);
}

}  // namespace curbstone::mapper::registration
