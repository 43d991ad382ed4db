#pragma once

namespace curbstone::map_export {

/// `curbstone export MAP`: writes a map file in other programs' formats. argv[0] is the subcommand's name. Returns the
/// exit status: 0 done, 2 wrong usage. Throws a one-line error if input or output fails; no partial output is left.
int run_export(int argc, char** argv);

}  // namespace curbstone::map_export
