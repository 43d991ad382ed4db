#include "tools/lidar_tool/lidar_tool.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <iostream>
#include <optional>
#include <stdexcept>

#include "common/config/command_line.hpp"
#include "tools/lidar_tool/info.hpp"
#include "tools/lidar_tool/packets.hpp"
#include "tools/lidar_tool/points.hpp"
#include "tools/lidar_tool/watch.hpp"
#include "tools/output/inputs.hpp"
#include "tools/output/new_file.hpp"

namespace curbstone::lidar_tool {

namespace {

struct Options {
  std::string what;
  std::string where;
  std::string out;
  std::string device;
  std::string model;
  int scan = 0;
  ListenOptions listen;
};

/// Writes to the file of --out, or to the standard output.
class Output {
 public:
  explicit Output(const std::string& file) : name_(file) {
    if (file.empty()) return;
    whole_.emplace(file, true);
    file_.open(whole_->part(), std::ios::binary);
    if (!file_) throw std::runtime_error(fmt::format("{}: cannot be written", file));
  }
  [[nodiscard]] std::ostream& stream() { return name_.empty() ? std::cout : file_; }
  void finish(std::int64_t points) {
    if (name_.empty()) return;  // guard_standard_streams() says what is lost there
    stream().flush();
    if (!stream()) throw std::runtime_error(fmt::format("{}: not written whole: is the disk full?", name_));
    file_.close();
    whole_->commit();
    fmt::print("{}: {} points\n", name_, points);
  }

 private:
  std::string name_;
  std::optional<output::NewFile> whole_;
  std::ofstream file_;
};

void print(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) fmt::print("{}\n", line);
  if (!lines.empty()) std::fflush(stdout);
}

void run_watch(const Options& options) {
  Watch watch;
  if (is_port(options.where)) {
    listen(
        std::stoi(options.where), options.listen, [&](const Packet& packet) { watch.on_packet(packet); },
        [&](std::int64_t now) { print(watch.on_time(now)); });
    return;
  }
  packets_from(options.where, options.listen)->for_each([&](const Packet& packet) {
    print(watch.on_time(packet.received));
    watch.on_packet(packet);
  });
}

/// Returns whether the capture is damaged, so that points may be missing.
bool run_points(const Options& options) {
  if (!options.out.empty()) output::refuse_to_overwrite({options.where}, options.out);
  const auto packets = packets_from(options.where, options.listen);
  const PointSource source = point_source(*packets, options.device, options.model);
  Output output(options.out);
  output.finish(options.what == "csv" ? write_csv(*packets, source, output.stream())
                                      : write_pcd(*packets, source, options.scan, output.stream()));
  return packets->damaged();
}

}  // namespace

int run_lidar(int argc, char** argv) {
  Options options;
  bool seconds_given = false;
  CommandLine line(
      "What a LiDAR sends. info: what is in it; csv: the points; pcd: the points of one revolution; watch: a line a "
      "second, is the sensor sane?",
      "curbstone lidar");
  line.argument("what", options.what, "info, csv, pcd or watch").required().one_of({"info", "csv", "pcd", "watch"});
  line.argument("where", options.where, "A capture (.pcap, .pcapng), or the UDP port to listen on").required();
  line.option("--out", options.out, "csv, pcd: the file to write; default: the standard output");
  line.option("--scan", options.scan, "pcd: which revolution, from 0").within(0, 1'000'000'000).shows_default();
  line.option("--device", options.device, "csv, pcd: the address of the device; default: the one that sends most");
  line.option("--model", options.model, "csv, pcd: rs16, helios16p, helios32 or vlp16; default: as its packets say");
  line.option("--seconds", options.listen.seconds,
              "How long to listen on a port; default: 3, watch: until it is stopped")
      .within(0.1, 1e6);
  line.option("--info-port", options.listen.info_port, "Of the device information; default: as devices are delivered")
      .within(1, 65535);
  if (const auto status = line.read(argc, argv)) return *status;
  seconds_given = line.given("--seconds");
  if (options.what == "watch" && !seconds_given) options.listen.seconds = 1e9;
  if (options.what == "info") {
    const auto packets = packets_from(options.where, options.listen);
    fmt::print("{}", info_text(*packets, options.where));
    return packets->damaged() ? 1 : 0;
  } else if (options.what == "watch") {
    run_watch(options);
  } else {
    return run_points(options) ? 1 : 0;
  }
  return 0;
}

}  // namespace curbstone::lidar_tool
