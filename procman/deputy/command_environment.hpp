#pragma once

namespace curbstone::procman::deputy {

/// Sets this process' environment, which its commands get: they are found beside the deputy first, and a vehicle's
/// config is where it is usually installed.
void prepare_command_environment();

}  // namespace curbstone::procman::deputy
