#include "tools/doctor/checks/vehicle_checks.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace curbstone::doctor::checks {

namespace {

constexpr double kMinHours = 1.0;  // of recording, for one drive

Verdict check_config(const ConfigFacts& config) {
  if (config.error.empty()) return good("config", config.file);
  return finding("config", config.error, fmt::format("edit {}; --config and --procman name other files", config.file));
}

Verdict check_running(const StaleService& running) {
  return finding(
      "config",
      fmt::format("{} runs with other settings than {} and the procman file have now", running.service, running.file),
      fmt::format("curbstone-sheriff restart {}; after changes of the procman file: systemctl restart "
                  "curbstone-deputy",
                  running.service));
}

Verdict check_program(const ProgramFacts& program) {
  return finding("program", fmt::format("{}: there is no program {}", program.command, program.program),
                 "install it, or correct exec in the procman file");
}

/// systemd hides the homes from the unit, and lets it write only into the folders that the unit names.
bool is_in_a_home(const std::string& folder) {
  return folder.starts_with("/home/") || folder == "/root" || folder.starts_with("/root/");
}

Verdict check_folder(const FolderFacts& folder, const std::string& user) {
  if (!folder.is_there && is_in_a_home(folder.folder)) {
    return finding("folder",
                   fmt::format("{}: {} is not there, or hidden from a unit of systemd", folder.setting, folder.folder),
                   "choose a folder outside of the homes; else systemctl edit curbstone-deputy: [Service] "
                   "ProtectHome=no");
  }
  if (folder.is_there && folder.is_read_only) {
    return finding("folder", fmt::format("{}: {} is on a read-only file system", folder.setting, folder.folder),
                   fmt::format("for the unit: systemctl edit curbstone-deputy: [Service] ReadWritePaths={}; else "
                               "mount -o remount,rw",
                               folder.folder));
  }
  if (!folder.is_there) {
    return finding("folder", fmt::format("{}: {} is not there", folder.setting, folder.folder),
                   fmt::format("install -d -o {} {}", user, folder.folder));
  }
  if (!folder.is_writable) {
    return finding("folder", fmt::format("{}: {} may not be written by {}", folder.setting, folder.folder, user),
                   fmt::format("chown {} {}", user, folder.folder));
  }
  return good("folder", fmt::format("{}: {}", folder.setting, folder.folder));
}

Verdict check_device(const DeviceFacts& device, const std::string& user) {
  if (!device.is_there) {
    return finding("device", fmt::format("{}: {} is not there", device.setting, device.file),
                   "plug it in, or set the name that it has: ls -l /dev/serial/by-id /dev/curbstone-*");
  }
  if (!device.is_usable) {
    return finding("device", fmt::format("{}: {} may not be opened by {}", device.setting, device.file, user),
                   fmt::format("usermod -aG {} {}, and log in anew", device.group, user));
  }
  return good("device", fmt::format("{}: {}", device.setting, device.file));
}

Verdict check_address(const AddressFacts& address) {
  if (!address.is_address) {
    return finding("address", fmt::format("{}: '{}' is no address", address.setting, address.address),
                   "write one of those that `ip address` shows, such as 192.168.1.102");
  }
  if (!address.is_ours) {
    return finding(
        "address", fmt::format("{}: no interface has {}", address.setting, address.address),
        fmt::format("ip address add {}/24 dev INTERFACE, and in its networkd file; or write one of those that "
                    "`ip address` shows",
                    address.address));
  }
  return good("address", fmt::format("{}: {}", address.setting, address.address));
}

Verdict check_can(const CanFacts& can, int bitrate) {
  const std::string up = fmt::format("ip link set {} down; ip link set {} up type can bitrate {} restart-ms 100",
                                     can.interface, can.interface, bitrate);
  if (!can.is_there)
    return finding("can", can.interface + " is not there", "plug the adapter in: ip link show; modprobe its driver");
  if (!can.is_up) return finding("can", can.interface + " is down", up);
  if (can.bitrate > 0 && can.bitrate != bitrate) {
    return finding("can", fmt::format("{} has {} bit/s, encoder.bitrate is {}", can.interface, can.bitrate, bitrate),
                   up);
  }
  if (can.state == "BUS-OFF" || can.state == "ERROR-PASSIVE") {
    return finding("can", fmt::format("{} is {}: nobody acknowledges its frames", can.interface, can.state),
                   "is the drive switched on, is the bus terminated at both ends, is the bit rate that of the drive?");
  }
  return good("can", fmt::format("{} is up, {} bit/s, {}", can.interface, can.bitrate, can.state));
}

Verdict check_lidar(const LidarFacts& lidar) {
  std::int64_t wanted = 0;
  std::string others;
  for (const auto& [sender, packets] : lidar.packets) {
    if (lidar.wanted_sender.empty() || sender == lidar.wanted_sender)
      wanted += packets;
    else
      others += (others.empty() ? "" : ", ") + sender;
  }
  if (wanted > 0) {
    return good("lidar",
                fmt::format("{:.0f} packets/s on port {}", static_cast<double>(wanted) / lidar.seconds, lidar.port));
  }
  if (!others.empty()) {
    return finding("lidar", fmt::format("{} sends to port {}, not {}", others, lidar.port, lidar.wanted_sender),
                   "lidar.device_address: the address of the device, or empty");
  }
  if (lidar.messages > 0) return good("lidar", "its driver sends LIDAR_POINTS");
  if (!lidar.listened) {
    return unknown("lidar", fmt::format("port {} belongs to a driver, which sends nothing", lidar.port),
                   "run this as root, who may look at the wire beside a driver");
  }
  const auto most = std::ranges::max_element(lidar.elsewhere, {}, [](const auto& seen) { return seen.second; });
  if (most != lidar.elsewhere.end()) {
    return finding("lidar",
                   fmt::format("no packet on port {}, but {:.0f} a second of a LiDAR's size to {}", lidar.port,
                               static_cast<double>(most->second) / lidar.seconds, most->first),
                   "set lidar.model and lidar.msop_port to the device, or the port in the device");
  }
  return finding(
      "lidar", fmt::format("no packet on port {} in {:.1f} s", lidar.port, lidar.seconds),
      fmt::format("power, cable, `ip address` (the device sends to one address); tcpdump -ni any udp port {}",
                  lidar.port));
}

Verdict check_disk(const DiskFacts& disk) {
  const double hours = static_cast<double>(disk.free_bytes) / disk.rate / 3600;
  const std::string text = fmt::format("{:.1f} h of recording are free in {}, at {:.1f} MB/s ({})", hours, disk.folder,
                                       disk.rate * 1e-6, disk.is_measured ? "measured" : "usual; nothing drives now");
  if (hours < kMinHours)
    return finding("disk", text, fmt::format("move logs away: du -sh {}/*; or set recorder.file", disk.folder));
  return good("disk", text);
}

}  // namespace

Verdicts check_vehicle(const VehicleFacts& facts) {
  Verdicts verdicts;
  for (const ConfigFacts& config : facts.configs) verdicts.push_back(check_config(config));
  for (const StaleService& running : facts.stale) verdicts.push_back(check_running(running));
  for (const ProgramFacts& program : facts.programs) {
    if (!program.is_there) verdicts.push_back(check_program(program));
  }
  for (const FolderFacts& folder : facts.folders) verdicts.push_back(check_folder(folder, facts.user));
  for (const DeviceFacts& device : facts.devices) verdicts.push_back(check_device(device, facts.user));
  for (const AddressFacts& address : facts.addresses) verdicts.push_back(check_address(address));
  if (facts.can) verdicts.push_back(check_can(*facts.can, facts.can_bitrate));
  if (facts.lidar) verdicts.push_back(check_lidar(*facts.lidar));
  if (facts.disk) verdicts.push_back(check_disk(*facts.disk));
  return verdicts;
}

}  // namespace curbstone::doctor::checks
