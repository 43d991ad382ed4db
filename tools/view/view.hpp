#pragma once

namespace curbstone::view {

/// `curbstone view MAP_OR_LOG...`: shows a saved map, or plays a drive, in the page of curbstone-viewer. argv[0] is the
/// subcommand's name.
int run_view(int argc, char** argv);

}  // namespace curbstone::view
