#include "tests/system/demo_drive.hpp"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <curbstone/semantic_tile_t.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "services/semantic_map/store/map_store.hpp"
#include "tests/paths.hpp"

namespace curbstone::system_test {

namespace {
constexpr double kPatience = 120;  // s: for what takes seconds on an idle machine
}  // namespace

MapContent read_map(const std::string& file) {
  const semantic_map::store::MapReader reader(file);
  MapContent content;
  for (const semantic_map::tile::MapTile& tile : reader.tiles()) {
    ++content.tiles;
    for (const semantic_map::tile::CellClass cell : tile.cell_class) ++content.cells[static_cast<std::size_t>(cell)];
  }
  content.curb_lines = static_cast<int>(reader.curbs().size());
  content.integrity = reader.integrity();
  return content;
}

double agreement(const std::string& map_file, const std::string& other_map_file) {
  std::map<TileKey, semantic_map::tile::MapTile> other;
  for (semantic_map::tile::MapTile& tile : semantic_map::store::MapReader(other_map_file).tiles())
    other.emplace(tile.key, tile);
  int same = 0;
  int known = 0;
  for (const semantic_map::tile::MapTile& tile : semantic_map::store::MapReader(map_file).tiles()) {
    const semantic_map::tile::MapTile& there = other[tile.key];
    for (std::size_t i = 0; i < tile.cell_class.size(); ++i) {
      if (tile.cell_class[i] == semantic_map::tile::CellClass::kUnknown &&
          there.cell_class[i] == semantic_map::tile::CellClass::kUnknown)
        continue;
      ++known;
      same += tile.cell_class[i] == there.cell_class[i] ? 1 : 0;
    }
    other.erase(tile.key);
  }
  for (const auto& [key, tile] : other) {
    for (const semantic_map::tile::CellClass cell : tile.cell_class)
      known += cell == semantic_map::tile::CellClass::kUnknown ? 0 : 1;
  }
  return known == 0 ? 0.0 : static_cast<double>(same) / known;
}

DemoDrive::DemoDrive(const std::string& source, const std::string& deputy_options, const DemoDevices& devices) {
  const auto driven = [](const map_pose_t& m) {
    return std::hypot(m.map_base_position[0], m.map_base_position[1], m.map_base_position[2]);
  };
  bus.bus.subscribe<map_pose_t>("MAP_POSE", [this, driven](const map_pose_t& message) {
    pose = message;
    ++revolutions;
    if (!driven_until_first_tile) driven_[message.utime] = driven(message);
  });
  bus.bus.subscribe<semantic_tile_t>("SEMANTIC_TILE", [this, driven](const semantic_tile_t& tile) {
    if (driven_until_first_tile || driven_.empty()) return;
    driven_until_first_tile = driven(pose);
    const auto then = driven_.lower_bound(tile.utime);
    driven_until_seen = then != driven_.end() ? then->second : driven_until_first_tile;
  });
  setenv("DEMO_OUT", folder_.path().c_str(), 1);
  const auto set = [](const char* name, const std::string& value) { setenv(name, value.c_str(), 1); };
  set("DEMO_SOURCE", source + " --imu " + devices.imu + " --encoder " + devices.encoder + " --lidar " + devices.lidar);
  set("DEMO_IMU", "--set model=" + devices.imu);
  set("DEMO_ENCODER", devices.encoder == "modbus" ? "--set interface=modbus_rtu" : "");
  set("DEMO_LIDAR", "--set model=" + devices.lidar + " --set msop_port=0 --set difop_port=0");
  set("DEMO_VIEWER", fmt::format("--set port={}", devices.viewer_port));
  setenv("CURBSTONE_CONFIG", test::source_path("config/ugv.yaml").c_str(), 1);
  deputy_ = std::make_unique<BackgroundProgram>("curbstone-deputy --config " + test::source_path("procman/demo.cfg") +
                                                    " --script go --exit-when simulate --log-dir " +
                                                    (folder_ / "logs").string() + " " + deputy_options,
                                                folder_ / "deputy.out");
}

bool DemoDrive::wait_for_scans(int wanted) {
  return bus.wait_until([&] { return revolutions >= wanted || !deputy_->running(); }, kPatience) && deputy_->running();
}

int DemoDrive::wait_for_end() {
  bus.wait_until([&] { return !deputy_->running(); }, kPatience);
  pressure_share_ = pressure_.share();
  return deputy_->wait(0);
}

bool DemoDrive::kill_and_see_it_come_back(const std::string& command) {
  const int pid = bus.pid(command);
  if (pid <= 0 || kill(pid, SIGKILL) != 0) return false;
  return bus.wait_until(
      [&] {
        const service_status_t* status = bus.status(command);
        return bus.pid(command) > 0 && bus.pid(command) != pid && status != nullptr && status->pid == bus.pid(command);
      },
      kPatience);
}

std::string DemoDrive::replay() const {
  const std::string file = folder_ / "replayed.db";
  const auto result = run_program("curbstone replay " + (folder_ / "run.lcmlog").string() + " --map " + file +
                                      " --config " + test::source_path("config/ugv.yaml"),
                                  100);
  if (result.exit_status != 0) throw std::runtime_error(result.err);
  return file;
}

int DemoDrive::map_files() const {
  const std::filesystem::directory_iterator files(folder_.path());
  return static_cast<int>(
      std::count_if(begin(files), end(files), [](const auto& file) { return file.path().extension() == ".db"; }));
}

std::vector<std::string> DemoDrive::losses() const {
  std::vector<std::string> losses;
  for (const auto& [service, status] : bus.services) {
    for (std::size_t i = 0; i < status.counter_name.size(); ++i) {
      const std::string& name = status.counter_name[i];
      if (status.counter_value[i] != 0 && (name == "dropped.queue" || name == "dropped.kernel")) {
        losses.push_back(fmt::format("{} {} {}", service, name, status.counter_value[i]));
      }
    }
  }
  return losses;
}

std::string DemoDrive::spoiled_by() const {
  const auto truth = nlohmann::json::parse(std::ifstream(folder_ / "truth/truth.json"));
  const double late = truth.at("latest_packet_s").get<double>();
  fmt::print("the emulator was at most {:.2f} s late; some program waited for the CPU in {:.0f} % of the time\n", late,
             100 * pressure_share_);
  if (late > kEmulatorLate) return fmt::format("the emulator itself came {:.2f} s late", late);
  if (pressure_share_ > kBusy)
    return fmt::format("some program waited for the CPU in {:.0f} % of the time", 100 * pressure_share_);
  return "";
}

std::map<std::string, std::string> DemoDrive::unwell(const std::vector<std::string>& names) const {
  std::map<std::string, std::string> unwell;
  for (const std::string& name : names) {
    const service_status_t* status = bus.status(name);
    if (status == nullptr)
      unwell[name] = "silent";
    else if (!bus.is_healthy(name))
      unwell[name] = fmt::format("{}", fmt::join(status->fault, "; "));
  }
  return unwell;
}

}  // namespace curbstone::system_test
