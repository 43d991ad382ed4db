#pragma once

namespace curbstone::replay {

/// `curbstone replay LOG...`: the nodes of the vehicle in one process, fed from logs in message-time order, with the
/// configuration that is recorded in the logs. argv[0] is the subcommand's name.
int run_replay(int argc, char** argv);

}  // namespace curbstone::replay
