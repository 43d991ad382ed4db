#pragma once

namespace curbstone::spy {

/// `curbstone spy`: who sends what on the bus, how fast, and how the services are. Returns the exit status: 0, 1 the
/// environment failed or, with --once, nothing came, 2 wrong usage.
int run_spy(int argc, char** argv);

}  // namespace curbstone::spy
