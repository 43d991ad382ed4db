#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/doctor/checks/verdict.hpp"

namespace curbstone::doctor::checks {

/// A configuration file of the vehicle.
struct ConfigFacts {
  std::string file;
  std::string error;  ///< one line, why it cannot be used; empty: it is valid
};

/// A service that runs with other settings than the files have now.
struct StaleService {
  std::string service;
  std::string file;  ///< the vehicle's
};

/// A program that the procman file starts.
struct ProgramFacts {
  std::string command;  ///< its id
  std::string program;
  bool is_there = false;
};

/// A folder that a process writes into.
struct FolderFacts {
  std::string setting;  ///< "recorder.file"
  std::string folder;
  bool is_there = false;
  bool is_writable = false;   ///< by the current user
  bool is_read_only = false;  ///< its file system, for this process
};

/// A serial port.
struct DeviceFacts {
  std::string setting;  ///< "imu.device"
  std::string file;
  bool is_there = false;
  bool is_usable = false;  ///< by the current user, for reading and writing
  std::string group;       ///< the group that may use it
};

/// An address of this host at which a process listens.
struct AddressFacts {
  std::string setting;  ///< "lidar.host_address"
  std::string address;
  bool is_address = false;  ///< of IPv4 or IPv6
  bool is_ours = false;     ///< of one of this host's interfaces
};

/// A CAN interface of the kernel, as reported by `ip -details link show`.
struct CanFacts {
  std::string interface;
  bool is_there = false;
  bool is_up = false;
  int bitrate = 0;    ///< bit/s; 0: unknown (a virtual one)
  std::string state;  ///< "ERROR-ACTIVE"
};

/// The senders to the LiDAR's port.
struct LidarFacts {
  int port = 0;
  bool listened = false;  ///< false: another program has the port, and raw sockets are not permitted
  double seconds = 0;
  std::map<std::string, std::int64_t> packets;    ///< by sender
  std::map<std::string, std::int64_t> elsewhere;  ///< of LiDAR size, other ports: by "port 2368, from 192.168.1.201"
  std::string wanted_sender;                      ///< empty: any
  std::int64_t messages = 0;                      ///< LIDAR_POINTS received on the bus meanwhile
};

/// Free space on the disk that the recorder writes to.
struct DiskFacts {
  std::string folder;
  std::int64_t free_bytes = 0;  ///< for the current user
  double rate = 0;              ///< bytes/s, of a recording
  bool is_measured = false;     ///< on the bus just now; otherwise the usual rate
};

struct VehicleFacts {
  std::string user;
  std::vector<ConfigFacts> configs;
  std::vector<StaleService> stale;
  std::vector<ProgramFacts> programs;
  std::vector<FolderFacts> folders;
  std::vector<DeviceFacts> devices;
  std::vector<AddressFacts> addresses;
  std::optional<CanFacts> can;
  int can_bitrate = 0;  ///< bit/s configured
  std::optional<LidarFacts> lidar;
  std::optional<DiskFacts> disk;
};

[[nodiscard]] Verdicts check_vehicle(const VehicleFacts& facts);

}  // namespace curbstone::doctor::checks
