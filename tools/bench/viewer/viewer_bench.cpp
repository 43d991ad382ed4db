#include "tools/bench/viewer/viewer_bench.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "common/config/command_line.hpp"
#include "services/viewer/page/page_files.hpp"
#include "tools/bench/viewer/page_figures.hpp"
#include "tools/bench/viewer/page_traffic.hpp"
#include "tools/bench/viewer/viewer_cpu.hpp"
#include "tools/browser/browser.hpp"
#include "tools/output/text_file.hpp"

namespace curbstone::bench::viewer {
namespace {

namespace page = curbstone::viewer::page;

constexpr double kCpuSeconds = 30;  // of the drive, for each figure

nlohmann::json traffic_json(const PageTraffic& traffic, double seconds) {
  nlohmann::json sections = nlohmann::json::object();
  for (const auto& [name, bytes] : traffic.sections) sections[name] = static_cast<double>(bytes) * 1e-6 / seconds;
  return {{"sections_mb_per_s", sections},
          {"mb_per_s", static_cast<double>(traffic.compressed) * 1e-6 / seconds},
          {"raw_mb_per_s", static_cast<double>(traffic.bytes) * 1e-6 / seconds},
          {"frames_per_s", static_cast<double>(traffic.frames) / seconds},
          {"frames", traffic.frames},
          {"bytes", traffic.bytes},
          {"largest_kb", static_cast<double>(traffic.largest) * 1e-3}};
}

void print_traffic(const nlohmann::json& json) {
  fmt::print("{:.1f} s of drive, {} tiles; the page's files: {:.0f} kB\n\n", json["seconds"].get<double>(),
             json["tiles"].get<int>(), json["bundle_kb"].get<double>());
  for (const auto& [name, says] : {std::pair{"map", "a page"},
                                   {"points", "with the LiDAR's points"},
                                   {"cloud", "with the dense cloud"},
                                   {"unread", "that reads nothing"}}) {
    const auto& traffic = json["traffic"][name];
    fmt::print("  {:<26} {:>7.3f} MB/s ({:.3f} before compression) {:>6.1f} frames/s, the largest {:.0f} kB\n", says,
               traffic["mb_per_s"].get<double>(), traffic["raw_mb_per_s"].get<double>(),
               traffic["frames_per_s"].get<double>(), traffic["largest_kb"].get<double>());
  }
  std::fflush(stdout);
}

void print_page(const nlohmann::json& page) {
  fmt::print(
      "\n  first picture of the map   {:>7.0f} ms, {:.0f} ms in a browser that has just been started\n"
      "  tile on the bus to screen  {:>7.0f} ms p50, {:.0f} ms p95\n",
      page["first_picture_warm_ms"].get<double>(), page["first_picture_cold_ms"].get<double>(),
      page["screen_ms"]["p50"].get<double>(), page["screen_ms"]["p95"].get<double>());
  for (const auto& [view, frames] : page["frames_per_s"].items())
    fmt::print("  {:.1f} million cells, {:<8} {:>7.1f} frames/s\n", page["cells"].get<double>() * 1e-6, view,
               frames.get<double>());
}

nlohmann::json cpu_json(const ViewerCpu& cpu) {
  return {{"seconds", cpu.seconds},
          {"without_page", cpu.without_page},
          {"with_two_pages", cpu.with_two_pages},
          {"frames_per_s", cpu.frames_per_s},
          {"mb_per_s", cpu.mb_per_s}};
}

void print_cpu(const ViewerCpu& cpu) {
  fmt::print(
      "\n  the viewer, {:.0f} s at pace     {:>6.3f} of a core without a page, {:.3f} with two that read ({:.1f} "
      "frames/s and "
      "{:.3f} MB/s each)\n",
      cpu.seconds, cpu.without_page, cpu.with_two_pages, cpu.frames_per_s, cpu.mb_per_s);
  std::fflush(stdout);
}

nlohmann::json measure(const std::string& log, bool draws) {
  const DriveTraffic drive = measure_traffic(log);
  const std::size_t files =
      page::page_js().size() + page::page_css().size() + page::index_html().size() + page::icon_svg().size();
  nlohmann::json json{{"seconds", drive.seconds},
                      {"tiles", drive.tiles.size()},
                      {"traffic",
                       {{"map", traffic_json(drive.map, drive.seconds)},
                        {"points", traffic_json(drive.points, drive.seconds)},
                        {"cloud", traffic_json(drive.cloud, drive.seconds)},
                        {"unread", traffic_json(drive.unread, drive.seconds)}}},
                      {"bundle_kb", static_cast<double>(files) * 1e-3}};
  print_traffic(json);
  if (!draws) return json;
  const ViewerCpu cpu = measure_cpu(log, kCpuSeconds);
  json["cpu"] = cpu_json(cpu);
  print_cpu(cpu);
  if (!browser::Browser::is_installed()) {
    fmt::print(stderr, "curbstone bench viewer: no chromium-headless-shell, so nothing is drawn\n");
    return json;
  }
  json["page"] = measure_pages(drive.tiles);
  print_page(json["page"]);
  return json;
}

}  // namespace

int run_bench_viewer(int argc, char** argv) {
  std::string log, json_file;
  bool only_traffic = false;
  CommandLine line(
      "What a page of curbstone-viewer costs the network in a recorded drive, on the clock of its messages, what the "
      "viewer takes of the processor, and how soon and how often the page draws in Chromium without a graphics card",
      "curbstone bench viewer");
  line.argument("log", log, "Log with LIDAR_POINTS, IMU and WHEELS").required();
  line.option("--json", json_file, "Write the figures to this file too");
  line.flag("--traffic", only_traffic,
            "Only what is counted; nothing is timed or drawn, so that a busy machine gives the same");
  if (const auto status = line.read(argc, argv)) return *status;
  const nlohmann::json json = measure(log, !only_traffic);
  if (!json_file.empty()) output::write_text(json_file, json.dump(2) + '\n');
  return 0;
}

}  // namespace curbstone::bench::viewer
