#pragma once

namespace curbstone::spy {

/// `curbstone spy`: the senders, channels and rates of the bus, and the health of the services. Returns the exit
/// status: 0, 1 if the environment failed or, with --once, nothing was received, 2 wrong usage.
int run_spy(int argc, char** argv);

}  // namespace curbstone::spy
