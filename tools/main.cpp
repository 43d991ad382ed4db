#include <fmt/format.h>

#include <array>
#include <string_view>

#include "common/config/standard_streams.hpp"
#include "common/config/version.hpp"
#include "tools/command/dispatch.hpp"
#include "tools/command/program_beside.hpp"
#include "tools/evaluate/evaluate.hpp"
#include "tools/lidar_tool/lidar_tool.hpp"
#include "tools/replay/replay.hpp"
#include "tools/simulate/simulate.hpp"

namespace {

using curbstone::command::Subcommand;

// Linked in: the demo's commands, and `lidar`, whose program name is that of the driver. The others are separate
// programs, so that the demo builds quickly.
constexpr std::array kSubcommands = {
    Subcommand{"simulate", "an emulated vehicle: sensor bytes or a log, and the truth",
               curbstone::simulate::run_simulate},
    Subcommand{"replay", "make a map from a log, as fast as the machine can", curbstone::replay::run_replay},
    Subcommand{"evaluate", "compare a map with the truth", curbstone::evaluate::run_evaluate},
    Subcommand{"lidar", "what is in a capture, is my sensor sane; its points as CSV or PCD",
               curbstone::lidar_tool::run_lidar},
    Subcommand{"log", "what is in a log; cut, join, repair or filter it; its fields as CSV, its scans as PCD"},
    Subcommand{"play", "say what the drivers said in a log on the bus"},
    Subcommand{"view", "a saved map, or a drive that is played, in a browser"},
    Subcommand{"spy", "who sends what on the bus, how fast, and how the services are"},
    Subcommand{"doctor", "what is wrong with this vehicle's PC, and how to mend it"},
    Subcommand{"localise", "place a drive on a saved map, and how well"},
    Subcommand{"detect", "curbs and classes of any cloud: .pcd, .ply, KITTI .bin"},
    Subcommand{"export", "a map for others: nav2, QGIS, Lanelet2, GeoJSON, PCD, PLY"},
    Subcommand{"calibrate", "wheels and extrinsics from a drive"},
    Subcommand{"exporter", "the figures of spy for Prometheus"},
    Subcommand{"bench", "measure: speed and accuracy, beside the peers"},
};

}  // namespace

int main(int argc, char** argv) {
  curbstone::guard_standard_streams();
  if (argc > 1 && std::string_view(argv[1]) == "--version") {
    fmt::print("{}\n", curbstone::version());
    return 0;
  }
  return curbstone::command::dispatch(kSubcommands, curbstone::command::own_folder(), argc, argv);
}
