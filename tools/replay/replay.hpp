#pragma once

namespace curbstone::replay {

/// `curbstone replay LOG...`: the nodes of the vehicle in one process, fed from logs in message-time order, configured
/// as the logs say that the processes were. argv[0] is
/// the subcommand's name.
int run_replay(int argc, char** argv);

}  // namespace curbstone::replay
