#pragma once

namespace curbstone::play {

/// `curbstone play LOG...`: publishes the drivers' messages of a log on the bus, for services, viewers and tools.
/// argv[0] is the subcommand's name.
int run_play(int argc, char** argv);

}  // namespace curbstone::play
