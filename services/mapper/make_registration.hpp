#pragma once

#include <memory>

#include "services/mapper/mapper_config.hpp"
#include "services/mapper/registration.hpp"

namespace curbstone {

/// The method that the config names, with an empty map.
[[nodiscard]] std::unique_ptr<Registration> make_registration(const MapperConfig& config);

}  // namespace curbstone
