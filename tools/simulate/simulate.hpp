#pragma once

namespace curbstone::simulate {

/// `curbstone simulate`: an emulated vehicle at the level of bytes. argv[0] is the subcommand's name.
int run_simulate(int argc, char** argv);

}  // namespace curbstone::simulate
