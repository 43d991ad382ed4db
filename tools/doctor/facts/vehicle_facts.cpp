#include "tools/doctor/facts/vehicle_facts.hpp"

#include <arpa/inet.h>
#include <grp.h>
#include <netinet/in.h>
#include <pwd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string_view>

#include "common/config/config.hpp"
#include "common/json/json_text.hpp"
#include "config/sections.hpp"
#include "drivers/encoder/encoder_config.hpp"
#include "drivers/imu/imu_config.hpp"
#include "drivers/lidar/lidar_config.hpp"
#include "drivers/lidar/models/make_model.hpp"
#include "procman/config/config.hpp"
#include "procman/config/exec_line.hpp"
#include "services/ekf/base/ekf_config.hpp"
#include "services/localizer/localizer_config.hpp"
#include "services/mapper/config/mapper_config.hpp"
#include "services/recorder/recorder_config.hpp"
#include "services/relay/relay_config.hpp"
#include "services/semantic_map/semantic_map_config.hpp"
#include "services/tensor_voting/worker/tensor_voting_config.hpp"
#include "services/viewer/viewer_config.hpp"
#include "tools/command/program_beside.hpp"
#include "tools/doctor/facts/program_output.hpp"

namespace curbstone::doctor::facts {

namespace {

namespace fs = std::filesystem;

/// Reads section by section, and collects each error once.
class SectionReader {
 public:
  /// `assignments`: SECTION.KEY=VALUE, from the command lines.
  SectionReader(std::string file, std::vector<std::string> assignments)
      : file_(std::move(file)), assignments_(std::move(assignments)) {}

  template <class Config>
  Config read(const std::string& section) {
    try {
      ConfigOf<Config> config;
      config.value = config_of<Config>(section, kProcessSections, file_, assignments_);
      hashes_[section] = config_hash(section, config);
      return config.value;
    } catch (const ConfigError& error) {
      if (std::ranges::find(errors_, error.what()) == errors_.end()) errors_.emplace_back(error.what());
    }
    return {};
  }
  /// Of the effective settings of the sections without an error.
  [[nodiscard]] const std::map<std::string, std::string>& hashes() const { return hashes_; }
  [[nodiscard]] std::vector<checks::ConfigFacts> result() const {
    if (errors_.empty()) return {{file_, ""}};
    std::vector<checks::ConfigFacts> facts;
    for (const std::string& error : errors_) facts.push_back({file_, error});
    return facts;
  }

 private:
  std::string file_;
  std::vector<std::string> assignments_;
  std::vector<std::string> errors_;
  std::map<std::string, std::string> hashes_;
};

checks::FolderFacts folder_at(const std::string& setting, fs::path folder) {
  if (folder.empty()) folder = ".";
  std::error_code hidden;  // by the permissions of a folder above
  struct statvfs disk {};
  const bool is_read_only = statvfs(folder.c_str(), &disk) == 0 && (disk.f_flag & ST_RDONLY) != 0;
  return {setting, folder.string(), fs::is_directory(folder, hidden), access(folder.c_str(), W_OK | X_OK) == 0,
          is_read_only};
}

checks::DeviceFacts device_at(const std::string& setting, const std::string& file) {
  struct stat status {};
  checks::DeviceFacts device{setting, file, stat(file.c_str(), &status) == 0, access(file.c_str(), R_OK | W_OK) == 0,
                             ""};
  const group* const owner = device.is_there ? getgrgid(status.st_gid) : nullptr;
  device.group = owner != nullptr ? owner->gr_name : "dialout";
  return device;
}

/// Whether a socket can have the address says whether an interface has it.
template <class Address>
bool is_of_an_interface(const Address& address) {
  const int fd = socket(reinterpret_cast<const sockaddr&>(address).sa_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  const bool is_bound = bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(fd);
  return is_bound;
}

checks::AddressFacts address_at(const std::string& setting, const std::string& text) {
  sockaddr_in v4{};
  v4.sin_family = AF_INET;
  if (inet_pton(AF_INET, text.c_str(), &v4.sin_addr) == 1) return {setting, text, true, is_of_an_interface(v4)};
  sockaddr_in6 v6{};
  v6.sin6_family = AF_INET6;
  if (inet_pton(AF_INET6, text.c_str(), &v6.sin6_addr) == 1) return {setting, text, true, is_of_an_interface(v6)};
  return {setting, text, false, false};
}

checks::CanFacts can_at(const std::string& interface) {
  checks::CanFacts can;
  can.interface = interface;
  const auto text = program_output({"ip", "-json", "-details", "link", "show", "dev", interface});
  const auto links = try_parse_json(text.value_or(""));
  if (!links.is_array()) return can;
  for (const auto& link : links) {
    can.is_there = true;
    const auto flags = link.value("flags", std::vector<std::string>());
    can.is_up = std::ranges::find(flags, "UP") != flags.end();
    const auto data = link.value("linkinfo", nlohmann::json::object()).value("info_data", nlohmann::json::object());
    can.state = data.value("state", "");
    can.bitrate = data.value("bittiming", nlohmann::json::object()).value("bitrate", 0);
  }
  return can;
}

/// Searches as the deputy does: in its own folder, then in $PATH.
bool program_exists(const std::string& program) {
  if (program.find('/') != std::string::npos) return access(program.c_str(), X_OK) == 0;
  const char* const path = std::getenv("PATH");
  std::istringstream folders(command::own_folder().string() + ":" + (path != nullptr ? path : ""));
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

std::vector<checks::ProgramFacts> programs_of(const procman::config::Config& config) {
  std::vector<checks::ProgramFacts> programs;
  for (const auto& command : config.commands) {
    const auto line = procman::config::parse_exec_line(command.exec, procman::config::from_environment);
    if (!line.argv.empty()) programs.push_back({command.id, line.argv.front(), program_exists(line.argv.front())});
  }
  return programs;
}

/// "tensor_voting" for "curbstone-tensor-voting"; empty for other programs.
std::string section_of(const std::string& word) {
  constexpr std::string_view kPrefix = "curbstone-";
  std::string name = fs::path(word).filename().string();
  if (!name.starts_with(kPrefix)) return "";
  name.erase(0, kPrefix.size());
  std::ranges::replace(name, '-', '_');
  return name;
}

/// The settings of a command line that override the file, as SECTION.KEY=VALUE. `words`: of the command, or of the
/// command that its shell executes.
std::vector<std::string> assignments_of(const std::vector<std::string>& words) {
  std::vector<std::string> assignments;
  std::string section;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (section.empty()) {
      section = section_of(words[i]);
    } else if (!section.empty() && words[i] == "--set" && i + 1 < words.size()) {
      assignments.push_back(section + "." + words[++i]);
    }
  }
  return assignments;
}

std::vector<std::string> assignments_of(const procman::config::Config& config) {
  std::vector<std::string> all;
  for (const auto& command : config.commands) {
    using procman::config::from_environment;
    auto words = procman::config::parse_exec_line(command.exec, from_environment).argv;
    const bool is_script = words.size() == 3 && fs::path(words[0]).filename() == "sh" && words[1] == "-c";
    if (is_script) words = procman::config::parse_exec_line(words[2], from_environment).argv;
    std::ranges::move(assignments_of(words), std::back_inserter(all));
  }
  return all;
}

/// The sections of those processes whose settings are told by `vehicle_file` and by their own command alone.
std::set<std::string> told_sections(const procman::config::Config& config, const std::string& vehicle_file) {
  const auto look_up = [&](const std::string& variable) {  // as in the deputy's environment
    return variable == "CURBSTONE_CONFIG" ? std::optional(vehicle_file) : procman::config::from_environment(variable);
  };
  std::set<std::string> told, untold;
  for (const auto& command : config.commands) {
    const auto words = procman::config::parse_exec_line(command.exec, look_up).argv;
    const std::string section = words.empty() ? "" : section_of(words.front());
    const auto file = std::ranges::find(words, "--config");
    std::error_code ignored;
    const bool is_told =
        file != words.end() && file + 1 != words.end() && fs::equivalent(file[1], vehicle_file, ignored);
    if (!told.insert(section).second || !is_told) untold.insert(section);
  }
  std::erase_if(told, [&](const std::string& section) { return section.empty() || untold.contains(section); });
  return told;
}

/// Returns the settings for the processes.
std::vector<std::string> read_procman(const std::string& file, const std::string& vehicle_file,
                                      checks::VehicleFacts& facts, std::set<std::string>& told) {
  try {
    const auto config = procman::config::load_config_file(file);
    told = told_sections(config, vehicle_file);
    facts.programs = programs_of(config);
    std::string wrong;
    for (const auto& script : config.scripts) {
      const std::vector<std::string> errors = procman::config::check_script(config, script);
      if (wrong.empty() && !errors.empty()) wrong = procman::config::join_errors(file, {errors.front()});
    }
    facts.configs.push_back({file, wrong});
    return assignments_of(config);
  } catch (const std::runtime_error& error) {
    const std::string text = error.what();
    facts.configs.push_back({file, text.substr(0, text.find('\n'))});
  }
  return {};
}

void look_for_devices(const imu::ImuConfig& imu, const encoder::EncoderConfig& encoder, checks::VehicleFacts& facts) {
  facts.devices.push_back(device_at("imu.device", imu.device));
  switch (encoder.interface) {
    case encoder::Interface::kSlcan:
    case encoder::Interface::kModbusRtu:
      facts.devices.push_back(device_at("encoder.device", encoder.device));
      break;
    case encoder::Interface::kSocketCan:
      facts.can = can_at(encoder.device);
      facts.can_bitrate = encoder.bitrate * 1000;
      break;
    default:
      break;
  }
}

std::string user_name() {
  const passwd* const user = getpwuid(geteuid());
  return user != nullptr ? user->pw_name : std::to_string(geteuid());
}

}  // namespace

VehicleWishes read_vehicle(const std::string& config_file, const std::string& procman_file) {
  VehicleWishes wishes;
  checks::VehicleFacts& facts = wishes.facts;
  facts.user = user_name();
  std::set<std::string> told;
  SectionReader reader(config_file, read_procman(procman_file, config_file, facts, told));
  const auto lidar = reader.read<lidar::LidarConfig>("lidar");
  const auto imu = reader.read<imu::ImuConfig>("imu");
  const auto encoder = reader.read<encoder::EncoderConfig>("encoder");
  const auto ekf = reader.read<ekf::base::EkfConfig>("ekf");
  const auto mapper = reader.read<mapper::config::MapperConfig>("mapper");
  (void)reader.read<tensor_voting::worker::TensorVotingConfig>("tensor_voting");
  (void)reader.read<localizer::LocalizerConfig>("localizer");
  const auto viewer = reader.read<viewer::ViewerConfig>("viewer");
  (void)reader.read<relay::RelayConfig>("relay");
  const auto map = reader.read<semantic_map::SemanticMapConfig>("semantic_map");
  const auto recorder = reader.read<recorder::RecorderConfig>("recorder");
  std::ranges::move(reader.result(), std::inserter(facts.configs, facts.configs.begin()));

  for (const auto& [section, hash] : reader.hashes()) {
    if (told.contains(section)) wishes.config_hashes[section] = hash;
  }

  const bool writes_sessions = recorder.file.empty();
  wishes.recorder_folder = writes_sessions ? recorder.folder : fs::path(recorder.file).parent_path().string();
  wishes.unrecorded_channel = recorder.skip;
  if (!map.map.empty()) facts.folders.push_back(folder_at("semantic_map.map", fs::path(map.map).parent_path()));
  facts.folders.push_back(folder_at(writes_sessions ? "recorder.folder" : "recorder.file", wishes.recorder_folder));
  if (!ekf.state_file.empty())
    facts.folders.push_back(folder_at("ekf.state_file", fs::path(ekf.state_file).parent_path()));
  if (!mapper.journal.empty())
    facts.folders.push_back(folder_at("mapper.journal", fs::path(mapper.journal).parent_path()));
  if (!mapper.folder.empty())
    facts.folders.push_back(folder_at("mapper.folder", fs::path(mapper.folder).parent_path()));
  look_for_devices(imu, encoder, facts);
  if (lidar.pcap.empty()) facts.addresses.push_back(address_at("lidar.host_address", lidar.host_address));
  if (viewer.network.empty()) facts.addresses.push_back(address_at("viewer.address", viewer.address));
  if (lidar.pcap.empty())
    wishes.lidar_port = lidar.msop_port != 0 ? lidar.msop_port : lidar::models::table_of(lidar.model).point_port;
  wishes.lidar_address = lidar.device_address;
  return wishes;
}

std::vector<checks::StaleService> stale_services(const VehicleWishes& wishes, const std::string& file,
                                                 const std::map<std::string, std::string>& running) {
  std::vector<checks::StaleService> stale;
  for (const auto& [service, hash] : running) {
    const auto wanted = wishes.config_hashes.find(service.substr(0, service.find(':')));
    if (wanted != wishes.config_hashes.end() && wanted->second != hash) stale.push_back({service, file});
  }
  return stale;
}

std::optional<checks::DiskFacts> read_disk(const std::string& folder) {
  struct statvfs status {};
  const std::string place = folder.empty() ? "." : folder;
  if (statvfs(place.c_str(), &status) != 0) return std::nullopt;
  checks::DiskFacts disk;
  disk.folder = place;
  disk.free_bytes = static_cast<std::int64_t>(status.f_bavail) * static_cast<std::int64_t>(status.f_frsize);
  return disk;
}

}  // namespace curbstone::doctor::facts
