#pragma once

namespace curbstone::doctor {

/// `curbstone doctor`: checks the bus, the vehicle's files and devices, and the host. Returns the exit status: 0 no
/// findings, 1 there are findings, 2 wrong usage.
int run_doctor(int argc, char** argv);

}  // namespace curbstone::doctor
