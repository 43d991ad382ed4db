#pragma once

#include <optional>
#include <string>

#include "common/config/config.hpp"
#include "drivers/lidar/decoding/packet_clock.hpp"

namespace curbstone::lidar {

/// The step in which the device counts distances.
enum class DistanceResolution {
  kAuto,  ///< by the device's firmware; 5 mm until it is known
  k5mm,
  k10mm,  ///< old firmware
};

/// m; nothing where the device decides.
[[nodiscard]] constexpr std::optional<double> distance_step(DistanceResolution resolution) {
  switch (resolution) {
    case DistanceResolution::kAuto:
      return std::nullopt;
    case DistanceResolution::k5mm:
      return 0.005;
    case DistanceResolution::k10mm:
      return 0.01;
  }
  return std::nullopt;
}

/// Section `lidar:` of the vehicle's file.
struct LidarConfig {
  int msop_port = 6699;
  int difop_port = 7788;
  std::string host_address = "0.0.0.0";  ///< interface to listen on
  std::string group_address;             ///< multicast group, where the device sends to one
  int receive_buffer = 4 << 20;          ///< bytes, of each socket; the kernel may grant less
  std::string device_address;            ///< of the device; packets of other senders are refused
  std::string pcap;                      ///< file instead of the network
  double pcap_rate = 1.0;                ///< times real time
  bool pcap_repeat = false;

  decoding::ClockMode clock = decoding::ClockMode::kAuto;
  double clock_tolerance = 1.0;  ///< s, auto: how far a sane device clock may be from the host's
  DistanceResolution distance_resolution = DistanceResolution::kAuto;
  double cut_angle = 180.0;  ///< deg
  double min_range = 0.4;    ///< m
  double max_range = 150.0;  ///< m
  bool publish_raw = false;

  void visit(ConfigVisitor& v) {
    v.field("msop_port", msop_port, {1, 65535}, "UDP port of the point packets");
    v.field("difop_port", difop_port, {1, 65535}, "UDP port of the device information; may be the same");
    v.field("host_address", host_address, "address of the interface to listen on; 0.0.0.0 = all");
    v.field("group_address", group_address, "multicast group to join; empty = none");
    v.field("device_address", device_address,
            "the device's own address: other senders are refused; empty = any sender");
    v.field("receive_buffer", receive_buffer, {65536, 1 << 28}, "bytes; capped by net.core.rmem_max");
    v.field("pcap", pcap, "read this capture instead of the network; empty = network");
    v.field("pcap_rate", pcap_rate, {0.01, 100.0}, "speed of the capture, times real time");
    v.field("pcap_repeat", pcap_repeat, "begin the capture anew at its end, with times that go on");
    using enum decoding::ClockMode;
    v.choice("clock", clock, {{"auto", kAuto}, {"device", kDevice}, {"host", kHost}},
             "time of the points: the device's (set by GPS), the host's, or the device's where it is sane");
    v.field("clock_tolerance", clock_tolerance, {0.001, 3600.0},
            "s; auto: a sane device clock is this near the host's");
    v.choice(
        "distance_resolution", distance_resolution,
        {{"auto", DistanceResolution::kAuto}, {"0.005", DistanceResolution::k5mm}, {"0.01", DistanceResolution::k10mm}},
        "m; auto: by the device's firmware, 0.005 until it is known");
    v.field("cut_angle", cut_angle, {0.0, 359.99}, "deg, clockwise from the lidar's x: where a revolution begins");
    v.field("min_range", min_range, {0.0, 300.0}, "m; nearer returns are left out");
    v.field("max_range", max_range, {0.1, 400.0}, "m; farther returns are left out");
    v.field("publish_raw", publish_raw, "send every packet as received on LIDAR_RAW, for logs");
  }
};

}  // namespace curbstone::lidar
