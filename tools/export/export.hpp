#pragma once

namespace curbstone::map_export {

/// `curbstone export MAP`: a map file in the formats of others. argv[0] is the subcommand's name. Returns the exit
/// status: 0 done, 2 wrong usage. Throws with one clear line when the input or the output fails; nothing half-written
/// stays then.
int run_export(int argc, char** argv);

}  // namespace curbstone::map_export
