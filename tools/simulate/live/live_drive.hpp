#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "tools/simulate/rig/drive.hpp"
#include "tools/simulate/rig/fault_plan.hpp"

namespace curbstone::simulate::live {

struct LiveOptions {
  std::string lidar_host = "127.0.0.1";
  int msop_port = 0;                            ///< 0: the device's default
  int difop_port = 0;                           ///< 0: the device's default
  std::string imu_link = "/tmp/curbstone-imu";  ///< path of the IMU's serial port
  std::string can_link = "/tmp/curbstone-can";  ///< path of the serial port of the CAN adapter or the drive
  bool witmotion = false;                       ///< the IMU is a WitMotion, not an Xsens
  bool modbus = false;                          ///< the drive is on a Modbus line, not on CAN
  std::string spool;                            ///< file of rendered packets, kept for the next run; empty: temporary
  std::uint64_t fingerprint = 0;                ///< of everything that the packets depend on
  double head_start = 0;                        ///< s that the devices run before the drive begins
  rig::FaultPlan faults;
};

/// Figures of a live drive.
struct LiveReport {
  double seconds = 0;
  std::int64_t packets = 0;
  std::int64_t imu = 0;
  std::int64_t wheels = 0;  ///< CAN frames, or Modbus replies
  std::int64_t start_utime = 0;
  double latest = 0;         ///< s, largest delay of a packet
  bool interrupted = false;  ///< SIGINT or SIGTERM
};

/// Sends a drive in real time as the devices do: LiDAR packets over UDP, and an Xsens or WitMotion and an SLCAN adapter
/// or a drive on Modbus on pseudo-terminals, which respond to the host. The serial ports exist from the start; the
/// drive begins when the packets have been rendered, and `on_start` is called then. Throws std::runtime_error with a
/// one-line message.
LiveReport run_live(const rig::Drive& drive, const LiveOptions& options,
                    const std::function<void(std::int64_t start_utime)>& on_start);

}  // namespace curbstone::simulate::live
