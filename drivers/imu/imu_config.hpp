#pragma once

#include <string>

#include "common/config/config.hpp"

namespace curbstone::imu {

/// The device's connection, which determines the transmission time of a frame.
enum class Line {
  kUsb,   ///< transmission time negligible
  kUart,  ///< ten bits per byte at the configured baud
};

/// The device's protocol.
enum class Model {
  kXsens,      ///< MTi: Xbus, MTData2
  kWitMotion,  ///< WT901 and similar: 11-byte frames that begin with 0x55
  kAuto,       ///< the model that is received first
};

/// Section `imu:` of a vehicle's file.
struct ImuConfig {
  Model model = Model::kXsens;
  std::string device = "/dev/ttyUSB0";  ///< serial port of the IMU
  int baud = 115200;
  bool low_latency = true;  ///< ask the port's driver not to hold bytes back
  Line line = Line::kUsb;
  int rate = 100;           ///< Hz
  bool configure = true;    ///< set the device up; false: it is set up already
  bool orientation = true;  ///< request the device's own orientation too
  double silence = 1.0;     ///< s without a sample that are a fault, and after which the device is set up again

  void visit(ConfigVisitor& v) {
    v.choice("model", model, {{"xsens", Model::kXsens}, {"witmotion", Model::kWitMotion}, {"auto", Model::kAuto}},
             "auto: whichever is heard first; nothing is sent to set it up until then");
    v.field("device", device,
            "serial port of the IMU; /dev/curbstone-imu (udev) and /dev/serial/by-id/... survive replugging");
    v.field("baud", baud, {4800, 4000000}, "any that device and port can; a USB device ignores it");
    v.field("low_latency", low_latency, "ask the port's driver not to hold bytes back (an FTDI chip does for 16 ms)");
    v.choice("line", line, {{"usb", Line::kUsb}, {"uart", Line::kUart}},
             "uart: stamps are put back by the time that a frame takes at this baud");
    v.field("rate", rate, {1, 400}, "Hz, of acceleration and rate of turn");
    v.field("configure", configure, "set the device up; false: it was set up by somebody else, nothing is sent");
    v.field("orientation", orientation, "ask for the device's own orientation too");
    v.field("silence", silence, {0.1, 60.0}, "s without a sample: a fault, and the device is set up again");
  }
};

}  // namespace curbstone::imu
