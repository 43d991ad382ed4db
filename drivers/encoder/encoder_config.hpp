#pragma once

#include <string>

#include "common/config/config.hpp"

namespace curbstone::encoder {

/// Connection to the drive.
enum class Interface {
  kSlcan,      ///< CAN by a serial adapter with SLCAN
  kSocketCan,  ///< the kernel's CAN
  kModbusRtu,  ///< Modbus on a serial line, RS485
  kModbusTcp,  ///< Modbus over TCP, through a gateway
  kFile,       ///< recorded CAN frames
};

/// Contents of raw CAN signals.
enum class SignalKind {
  kNone,    ///< no signals: the drive speaks CANopen
  kCounts,  ///< encoder counts
  kSpeeds,  ///< wheel speeds
};

/// Section `encoder.signals:`: wheels read from raw CAN frames.
struct SignalsConfig {
  SignalKind kind = SignalKind::kNone;
  std::string left = "181 0|32@1-";
  std::string right = "181 32|32@1-";

  void visit(ConfigVisitor& v) {
    v.choice("kind", kind,
             {{"none", SignalKind::kNone}, {"counts", SignalKind::kCounts}, {"speeds", SignalKind::kSpeeds}},
             "none: a CANopen drive; counts, speeds: what these signals are");
    v.field("left", left,
            "ID START|LENGTH@ORDER SIGN (FACTOR,OFFSET), bits numbered as in a DBC file; speeds in rad/s");
    v.field("right", right, "the same of the right wheel: 181 32|32@1- (1,0)");
  }
};

/// Section `encoder.modbus:`.
struct ModbusConfig {
  std::string host = "192.168.1.10";  ///< IPv4 address of the gateway
  int port = 502;
  int slave = 1;     ///< the drive's id on its serial line
  double rate = 50;  ///< Hz, of the positions
  int timeout = 60;  ///< ms from request to reply; later replies are refused

  void visit(ConfigVisitor& v) {
    v.field("host", host, "IPv4 address of the gateway, for modbus_tcp");
    v.field("port", port, {1, 65535}, "TCP port of the gateway");
    v.field("slave", slave, {1, 127}, "id of the drive on its RS485 line");
    v.field("rate", rate, {1, 100}, "Hz, of the positions: 50 is safe at 115200 baud");
    v.field("timeout", timeout, {10, 500}, "ms from request to whole reply; a later one is refused");
  }
};

/// Section `encoder:` of a vehicle's file.
struct EncoderConfig {
  Interface interface = Interface::kSlcan;
  std::string device = "/dev/ttyACM0";  ///< serial port, or network interface ("can0")
  int baud = 115200;                    ///< of the serial port
  int bitrate = 500;                    ///< kbit/s of the CAN bus, for slcan; socketcan's is set by `ip link`
  int node = 1;                         ///< CANopen node id of the drive
  bool configure = true;                ///< set the drive up; false: another master does, this one only listens
  int period = 10;                      ///< ms between position samples
  double event_timer_unit = 0.5;        ///< ms; of object 1800:05
  double counts_per_revolution = 4096;  ///< of a wheel; usually 4 x the encoder's lines
  bool check_encoder_lines = true;      ///< compare counts_per_revolution with the drive's own value
  bool invert_left = false;             ///< the wheel counts down when the vehicle drives forward
  bool invert_right = true;
  double max_speed = 150;  ///< rad/s of a wheel, 25 m/s at 0.17 m: more means a corrupted frame
  double silence = 0.5;    ///< s without positions that are a fault, and after which the drive is set up again
  ModbusConfig modbus;
  SignalsConfig signals;
  std::string file;      ///< candump log or PCAN trace, for file
  double file_rate = 1;  ///< times real time; 0: as fast as it can be read

  void visit(ConfigVisitor& v) {
    v.choice("interface", interface,
             {{"slcan", Interface::kSlcan},
              {"socketcan", Interface::kSocketCan},
              {"modbus_rtu", Interface::kModbusRtu},
              {"modbus_tcp", Interface::kModbusTcp},
              {"file", Interface::kFile}},
             "slcan: a serial CAN adapter; socketcan: the kernel's CAN; modbus_rtu: RS485; modbus_tcp: a gateway; "
             "file: recorded");
    v.field("device", device, "serial port (/dev/ttyACM0), or network interface (can0)");
    v.field("baud", baud, {9600, 2000000},
            "of the serial port, for slcan and modbus_rtu; a USB CAN adapter ignores it");
    v.field("bitrate", bitrate, {10, 1000}, "kbit/s of the CAN bus, for slcan; socketcan's is set by `ip link`");
    v.field("node", node, {1, 127}, "CANopen node id of the drive");
    v.field("configure", configure, "set the drive up; false: another master does, nothing is sent");
    v.field("period", period, {2, 100}, "ms between position samples");
    v.field("event_timer_unit", event_timer_unit, {0.1, 1.0},
            "ms, of object 1800:05: 0.5 for ZLTECH, 1 by the standard");
    v.field("counts_per_revolution", counts_per_revolution, {1, 1e7}, "of a wheel; usually 4 x the encoder's lines");
    v.field("check_encoder_lines", check_encoder_lines, "say so when the drive's encoder lines do not fit that");
    v.field("invert_left", invert_left, "the left wheel counts down when the vehicle drives forward");
    v.field("invert_right", invert_right, "the same of the right wheel, which is mounted mirrored");
    v.field("max_speed", max_speed, {1, 1000}, "rad/s of a wheel: more is a corrupted frame");
    v.field("silence", silence, {0.1, 60.0}, "s without positions: a fault, and the drive is set up again");
    v.section("modbus", modbus, "for modbus_rtu and modbus_tcp");
    v.section("signals", signals, "raw CAN signals instead of a CANopen drive");
    v.field("file", file, "recorded CAN, for file: a log of candump (-l, -ta, -tA, -tz), or a PCAN trace (.trc)");
    v.field("file_rate", file_rate, {0, 1000}, "speed of the recording, times real time; 0: as fast as it can be read");
  }
};

}  // namespace curbstone::encoder
