#pragma once

namespace curbstone::localise {

/// `curbstone localise MAP --log LOG...`: a drive placed on a saved map, and how well. argv[0] is the subcommand's
/// name.
int run_localise(int argc, char** argv);

}  // namespace curbstone::localise
