#pragma once

#include <optional>
#include <set>
#include <string>

#include "common/config/config.hpp"
#include "drivers/lidar/decoding/packet_clock.hpp"
#include "drivers/lidar/models/make_model.hpp"

namespace curbstone::lidar {

/// The unit of the device's distances.
enum class DistanceResolution {
  kAuto,  ///< by the device's firmware; 5 mm until it is known
  k5mm,
  k10mm,  ///< old firmware
};

/// m; nothing if the device decides.
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
  models::ModelName model = models::ModelName::kRs16;
  int msop_port = 0;                     ///< 0 = the model's own
  int difop_port = 0;                    ///< 0 = the model's own
  std::string host_address = "0.0.0.0";  ///< interface to listen on
  std::string group_address;             ///< multicast group, where the device sends to one
  int receive_buffer = 4 << 20;          ///< bytes per socket; the kernel may grant less
  std::string device_address;            ///< of the device; packets of other senders are refused
  std::string pcap;                      ///< file to read instead of the network
  double pcap_rate = 1.0;                ///< times real time
  bool pcap_repeat = false;

  decoding::ClockMode clock = decoding::ClockMode::kAuto;
  double clock_tolerance = 0.02;  ///< s, for kAuto: maximum difference of a valid device clock from the host's
  double time_offset = 0.0;       ///< s, added to the device's stamps
  DistanceResolution distance_resolution = DistanceResolution::kAuto;
  double cut_angle = 180.0;  ///< deg
  int split_packets = 0;     ///< 0 = a revolution ends at cut_angle
  double min_range = 0.4;    ///< m
  double max_range = 150.0;  ///< m
  double start_angle = 0.0;  ///< deg
  double end_angle = 360.0;  ///< deg
  std::string angles_file;
  bool wait_for_difop = false;
  int most_lost = 15;                    ///< packets per second
  std::string channel = "LIDAR_POINTS";  ///< one per device on the bus
  std::string raw_channel = "LIDAR_RAW";
  bool publish_raw = false;

  void visit(ConfigVisitor& v) {
    v.choice("model", model,
             {{"auto", models::ModelName::kAuto},
              {"rs16", models::ModelName::kRs16},
              {"helios16p", models::ModelName::kHelios16p},
              {"helios32", models::ModelName::kHelios32},
              {"vlp16", models::ModelName::kVlp16}},
             "the device; auto: by its packets");
    v.field("msop_port", msop_port, {0, 65535}, "UDP port of the point packets; 0: the model's own");
    v.field("difop_port", difop_port, {0, 65535},
            "UDP port of the device information; may be the same; 0: the model's own");
    v.field("host_address", host_address, "address of the interface to listen on; 0.0.0.0 = all");
    v.field("group_address", group_address, "multicast group to join; empty = none");
    v.field("device_address", device_address,
            "the device's own address: other senders are refused; empty = any sender");
    v.field("receive_buffer", receive_buffer, {65536, 1 << 28}, "bytes; capped by net.core.rmem_max");
    v.field("pcap", pcap, "read this capture instead of the network; empty = network");
    v.field("pcap_rate", pcap_rate, {0.01, 100.0}, "speed of the capture, times real time");
    v.field("pcap_repeat", pcap_repeat, "restart the capture at its end, with continuing times");
    using enum decoding::ClockMode;
    v.choice("clock", clock, {{"auto", kAuto}, {"device", kDevice}, {"host", kHost}},
             "time of the points: the device's (set by GPS), the host's, or the device's where it agrees with a "
             "synchronised host's");
    v.field("clock_tolerance", clock_tolerance, {0.001, 3600.0},
            "s; auto: a sane device clock is this near the host's");
    v.field("time_offset", time_offset, {-1e5, 1e5},
            "s, added to the device's stamps; 37 where its clock is that much behind (TAI - UTC)");
    v.choice(
        "distance_resolution", distance_resolution,
        {{"auto", DistanceResolution::kAuto}, {"0.005", DistanceResolution::k5mm}, {"0.01", DistanceResolution::k10mm}},
        "m; auto: by the device's firmware, 0.005 until it is known");
    v.field("cut_angle", cut_angle, {0.0, 359.99}, "deg, clockwise from the lidar's x: where a revolution begins");
    v.field("split_packets", split_packets, {0, 100'000},
            "packets of a revolution, wherever the head is; 0: it ends at cut_angle");
    v.field("min_range", min_range, {0.0, 300.0}, "m; nearer returns are left out");
    v.field("max_range", max_range, {0.1, 400.0}, "m; farther returns are left out");
    v.field("start_angle", start_angle, {0.0, 360.0}, "deg, clockwise from x: returns from here ...");
    v.field("end_angle", end_angle, {0.0, 360.0}, "... to here are published, through 0 if this is the smaller angle");
    v.field("angles_file", angles_file,
            "CSV with a line a laser in firing order: elevation[,azimuth] in deg; empty = the device's own");
    v.field("wait_for_difop", wait_for_difop, "no points before the device has sent its angles");
    v.field("most_lost", most_lost, {1, 1'000'000}, "packets a second; more lost than this is a fault");
    v.field("channel", channel, "of the points: another one for each further device on the bus");
    v.field("raw_channel", raw_channel, "of the packets as received");
    v.field("publish_raw", publish_raw, "send every packet as received on raw_channel, for logs");
  }
};

/// UDP ports of the configuration, else of the model.
[[nodiscard]] inline int point_port(const LidarConfig& config) {
  return config.msop_port != 0 ? config.msop_port : models::table_of(config.model).point_port;
}
[[nodiscard]] inline int info_port(const LidarConfig& config) {
  return config.difop_port != 0 ? config.difop_port : models::table_of(config.model).info_port;
}

/// All UDP ports to listen on. While the model is unknown and no port is configured: those of all models.
[[nodiscard]] inline std::set<int> ports_of(const LidarConfig& config) {
  std::set<int> ports = {point_port(config), info_port(config)};
  if (config.model != models::ModelName::kAuto) return ports;
  for (const models::ModelTable* table : models::tables()) {
    if (config.msop_port == 0) ports.insert(table->point_port);
    if (config.difop_port == 0) ports.insert(table->info_port);
  }
  return ports;
}

}  // namespace curbstone::lidar
