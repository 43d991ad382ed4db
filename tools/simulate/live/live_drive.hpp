#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "tools/simulate/rig/drive.hpp"
#include "tools/simulate/rig/fault_plan.hpp"

namespace curbstone::simulate::live {

struct LiveOptions {
  std::string lidar_host = "127.0.0.1";
  int msop_port = 0;                            ///< 0 = the device's own
  int difop_port = 0;                           ///< 0 = the device's own
  std::string imu_link = "/tmp/curbstone-imu";  ///< where the IMU's serial port appears
  std::string can_link = "/tmp/curbstone-can";  ///< where the CAN adapter's, or the drive's, serial port appears
  bool witmotion = false;                       ///< the IMU is a WitMotion, not an Xsens
  bool modbus = false;                          ///< the drive is on a Modbus line, not on CAN
  std::string spool;                            ///< file of rendered packets, kept for the next run; empty: temporary
  std::uint64_t fingerprint = 0;                ///< of all that the packets depend on
  double head_start = 0;                        ///< s that the devices are on before the drive begins
  rig::FaultPlan faults;
};

/// What a live drive came to.
struct LiveReport {
  double seconds = 0;
  std::int64_t packets = 0;
  std::int64_t imu = 0;
  std::int64_t wheels = 0;  ///< CAN frames, or Modbus replies
  std::int64_t start_utime = 0;
  double latest = 0;         ///< s, how late the latest packet was
  bool interrupted = false;  ///< SIGINT or SIGTERM
};

/// Sends a drive in real time as the devices do: LiDAR packets over UDP, an Xsens or WitMotion and an SLCAN adapter, or
/// a drive on Modbus, on pseudo-terminals that answer what the host writes. The serial ports are there from the start;
/// the drive begins when the packets have been rendered, and `on_start` hears of it. Throws std::runtime_error with one
/// clear line.
LiveReport run_live(const rig::Drive& drive, const LiveOptions& options,
                    const std::function<void(std::int64_t start_utime)>& on_start);

}  // namespace curbstone::simulate::live
