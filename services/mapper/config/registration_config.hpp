#pragma once

#include "common/config/config.hpp"
#include "services/mapper/config/icp_config.hpp"
#include "services/mapper/config/loam_config.hpp"

namespace curbstone::mapper::config {

/// Registration methods.
enum class RegistrationMethod {
  kIcp,   ///< points to planes
  kLoam,  ///< edges and planes
};

/// The registration method, and the settings of each method.
struct RegistrationConfig {
  RegistrationMethod method = RegistrationMethod::kIcp;
  IcpConfig icp;
  LoamConfig loam;

  void visit(ConfigVisitor& v) {
    v.choice("method", method, {{"icp", RegistrationMethod::kIcp}, {"loam", RegistrationMethod::kLoam}},
             "of registration");
    v.section("icp", icp, "point-to-plane registration");
    v.section("loam", loam, "registration by edges and planes");
  }
};

}  // namespace curbstone::mapper::config
