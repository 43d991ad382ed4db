#pragma once

namespace curbstone::localise {

/// `curbstone localise MAP --log LOG...`: localises a drive in a saved map, and scores the result. argv[0] is the
/// subcommand's name.
int run_localise(int argc, char** argv);

}  // namespace curbstone::localise
