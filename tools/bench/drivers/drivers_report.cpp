#include "tools/bench/drivers/drivers_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/output/text_file.hpp"

namespace curbstone::bench::drivers {

void print_report(const DriversReport& report) {
  fmt::print("LiDAR, on one core: medians of CPU time\n");
  fmt::print("  {:<20} {:>9} {:>9} {:>11} {:>9} {:>9} {:>11} {:>9} {:>12}\n", "", "sent/s", "points", "decode/s",
             "ns/point", "x real", "driver/s", "x real", "memcpy/s");
  for (const LidarRate& r : report.lidars) {
    fmt::print("  {:<20} {:>9.0f} {:>9.0f} {:>11.0f} {:>9.2f} {:>9.0f} {:>11.0f} {:>9.0f} {:>12.0f}\n", r.name, r.pace,
               r.points_a_packet, r.decode_per_s, r.ns_a_point(), r.times_real(), r.driver_per_s, r.driver_times_real(),
               r.memcpy_per_s);
  }
  fmt::print("\nIMU samples and CAN frames\n");
  fmt::print("  {:<20} {:>9} {:>9} {:>11} {:>9} {:>9} {:>12}\n", "", "sent/s", "bytes", "driver/s", "MB/s", "x real",
             "memcpy/s");
  for (const StreamRate& r : report.streams) {
    fmt::print("  {:<20} {:>9.0f} {:>9.0f} {:>11.0f} {:>9.1f} {:>9.0f} {:>12.0f}\n", r.name, r.pace, r.bytes,
               r.driver_per_s, r.driver_per_s * r.bytes * 1e-6, r.times_real(), r.memcpy_per_s);
  }
}

void write_report(const DriversReport& report, const std::string& file) {
  nlohmann::json json;
  for (const LidarRate& r : report.lidars) {
    json["lidar"][r.name] = {{"sent_per_s", r.pace},
                             {"points_per_packet", r.points_a_packet},
                             {"decode_packets_per_s", r.decode_per_s},
                             {"decode_ns_per_point", r.ns_a_point()},
                             {"decode_times_real", r.times_real()},
                             {"driver_packets_per_s", r.driver_per_s},
                             {"driver_times_real", r.driver_times_real()},
                             {"memcpy_packets_per_s", r.memcpy_per_s}};
  }
  for (const StreamRate& r : report.streams) {
    json["streams"][r.name] = {{"sent_per_s", r.pace},
                               {"bytes", r.bytes},
                               {"driver_per_s", r.driver_per_s},
                               {"driver_bytes_per_s", r.driver_per_s * r.bytes},
                               {"driver_times_real", r.times_real()},
                               {"memcpy_per_s", r.memcpy_per_s}};
  }
  output::write_text(file, json.dump(2) + '\n');
}

}  // namespace curbstone::bench::drivers
