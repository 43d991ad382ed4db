#pragma once

#include <Eigen/Core>
#include <memory>

#include "services/mapper/config/registration_config.hpp"
#include "services/mapper/registration/registration.hpp"

namespace curbstone::mapper::registration {

/// Creates the registration method that the config names, with an empty map. `lidar`: its position in base_link, m.
[[nodiscard]] std::unique_ptr<Registration> make_registration(const config::RegistrationConfig& config,
                                                              const Eigen::Vector3d& lidar);

}  // namespace curbstone::mapper::registration
