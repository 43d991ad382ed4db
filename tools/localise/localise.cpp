#include "tools/localise/localise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/config/assignments.hpp"
#include "common/config/command_line.hpp"
#include "common/config/config.hpp"
#include "common/json/json_text.hpp"
#include "services/ekf/ekf_node.hpp"
#include "services/localizer/localizer_node.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "tools/evaluate/truth/truth.hpp"
#include "tools/localise/drive_picture.hpp"
#include "tools/localise/pose_errors.hpp"
#include "tools/output/ordered_log.hpp"
#include "tools/output/text_file.hpp"
#include "tools/output/watched_log.hpp"
#include "tools/recording/recorded_config.hpp"

namespace curbstone::localise {
namespace {

constexpr std::array<std::string_view, 2> kSections = {"ekf", "localizer"};

struct Arguments {
  std::string map;
  std::vector<std::string> logs, assignments;
  std::vector<double> start;
  bool from_truth = false, recorded = false;
  std::string config, truth, map_truth, csv, json, picture;
};

/// The drive through ekf and localizer, in message-time order, as live.
struct Localised {
  std::vector<map_pose_t> poses;
  NodeReport report;
};

/// The recorded output of the live localizer.
Localised said_live(output::WatchedLog& log) {
  Localised out;
  LocalBus bus;
  bus.subscribe<map_pose_t>("LOCALIZED_POSE", [&](const map_pose_t& pose) { out.poses.push_back(pose); });
  const auto is_pose = [](const std::string& channel) { return channel == "LOCALIZED_POSE"; };
  output::read_in_order(log, is_pose, [&](const LogEvent& event) {
    bus.inject(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    bus.dispatch();
  });
  return out;
}

Localised localise(output::WatchedLog& log, const ekf::base::EkfConfig& ekf_config,
                   const localizer::LocalizerConfig& config) {
  LocalBus bus;
  ekf::EkfNode ekf(ekf_config, bus);
  localizer::LocalizerNode node(config, bus);
  ekf.connect(bus);
  node.connect(bus);
  Localised out;
  bus.subscribe<map_pose_t>("LOCALIZED_POSE", [&](const map_pose_t& pose) { out.poses.push_back(pose); });
  const auto deliver = [&](const LogEvent& event) {
    bus.inject(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    bus.dispatch();
  };
  output::read_in_order(log, output::is_of_a_driver, deliver);
  ekf.finish();
  bus.dispatch();
  node.finish();
  bus.dispatch();
  out.report = node.report();
  return out;
}

std::string to_csv(const std::vector<map_pose_t>& poses) {
  std::string text = "utime,x,y,z,qw,qx,qy,qz,sigma_x,sigma_y,sigma_yaw,matched,degenerate,flags\n";
  for (const map_pose_t& m : poses) {
    const double* p = m.map_base_position;
    const double* q = m.map_base_orientation;
    const auto sigma = [&](int i) { return std::sqrt(static_cast<double>(m.covariance[i * 7])); };
    text += fmt::format("{},{:.4f},{:.4f},{:.4f},{:.7f},{:.7f},{:.7f},{:.7f},{:.4f},{:.4f},{:.6f},{:.3f},{},{}\n",
                        m.utime, p[0], p[1], p[2], q[0], q[1], q[2], q[3], sigma(0), sigma(1), sigma(5),
                        static_cast<double>(m.inlier_ratio), m.degenerate, m.flags);
  }
  return text;
}

std::string to_table(const PoseErrors& e) {
  return fmt::format(
      "  not lost and with a truth    {} of {} revolutions, {} lost\n"
      "  lateral        RMSE {:.3f} m, 99 % {:.3f} m\n"
      "                 RMSE {:.3f} m, 99 % {:.3f} m where the longitudinal pose is degenerate\n"
      "  longitudinal   RMSE {:.3f} m, 99 % {:.3f} m where not degenerate ({} revolutions are)\n"
      "  yaw            RMSE {:.3f} deg\n"
      "  NEES (3)       mean {:.2f}, {:.1f} % beyond the 95 % bound\n"
      "                 lateral {:.2f}, longitudinal {:.2f}, yaw {:.2f}: 1 each where its sigma is right\n"
      "  worst          {:.3f} m; {} revolutions wrong by 0.5 m and not lost\n",
      e.judged, e.poses, e.lost, e.lateral_rmse, e.lateral_99, e.lateral_degenerate_rmse, e.lateral_degenerate_99,
      e.longitudinal_rmse, e.longitudinal_99, e.degenerate, e.yaw_rmse, e.nees, 100 * e.beyond_95, e.nees_lateral,
      e.nees_longitudinal, e.nees_yaw, e.worst, e.wrong_and_sure);
}

nlohmann::json to_json(const PoseErrors& e) {
  // null, not 0, if all revolutions are degenerate: there is no error to state.
  const auto where_observable = [&](double value) {
    return e.judged > e.degenerate ? nlohmann::json(value) : nlohmann::json();
  };
  return {{"revolutions", e.poses},
          {"lost", e.lost},
          {"judged", e.judged},
          {"lateral_rmse_m", e.lateral_rmse},
          {"lateral_99_m", e.lateral_99},
          {"lateral_degenerate_rmse_m", e.lateral_degenerate_rmse},
          {"lateral_degenerate_99_m", e.lateral_degenerate_99},
          {"longitudinal_rmse_m", where_observable(e.longitudinal_rmse)},
          {"longitudinal_99_m", where_observable(e.longitudinal_99)},
          {"longitudinal_all_rmse_m", e.longitudinal_all},
          {"degenerate", e.degenerate},
          {"yaw_rmse_deg", e.yaw_rmse},
          {"nees_mean", e.nees},
          {"nees_lateral", e.nees_lateral},
          {"nees_longitudinal", e.nees_longitudinal},
          {"nees_yaw", e.nees_yaw},
          {"nees_beyond_95", e.beyond_95},
          {"worst_m", e.worst},
          {"wrong_and_not_lost", e.wrong_and_sure}};
}

/// Sets the start from --start or the true pose; otherwise it remains as configured, which may be unknown.
void set_start(const Arguments& arguments, const std::optional<TrueMapPose>& truth,
               const evaluate::truth::Trajectory& poses, localizer::LocalizerConfig& config) {
  if (!arguments.start.empty()) config.start = arguments.start;
  if (!arguments.from_truth) return;
  const auto T_map_base = truth->at(poses.front().utime);
  if (!T_map_base) throw std::runtime_error("the drive does not begin on the map: say where, --start X,Y,YAW");
  const Eigen::Vector3d& p = T_map_base->translation();
  config.start = {p.x(), p.y(), roll_pitch_yaw(T_map_base->linear()).z()};
}

ekf::base::EkfConfig filter_of(const Arguments& arguments, const recording::RecordedConfig& recorded) {
  auto config =
      recording::config_of<ekf::base::EkfConfig>("ekf", arguments.config, recorded, arguments.assignments).value;
  config.state_file.clear();  // its state is of another vehicle or time
  return config;
}

localizer::LocalizerConfig localizer_of(const Arguments& arguments, const recording::RecordedConfig& recorded) {
  auto config = recording::config_of<localizer::LocalizerConfig>("localizer", arguments.config, recorded, {});
  if (arguments.config.empty()) config.value.start.clear();  // a recorded one may be on another map
  set_section_values("localizer", arguments.assignments, config);
  config.value.map = arguments.map;
  return config.value;
}

int run(const Arguments& arguments) {
  LogFiles head(arguments.logs);
  const recording::RecordedConfig recorded = recording::recorded_config(head);
  localizer::LocalizerConfig config = localizer_of(arguments, recorded);
  std::optional<TrueMapPose> truth;
  evaluate::truth::Trajectory drive;
  if (!arguments.truth.empty()) {
    drive = evaluate::truth::load_truth(arguments.truth).poses;
    truth.emplace(semantic_map::store::MapReader(arguments.map).trajectory(),
                  evaluate::truth::load_truth(arguments.map_truth).poses, drive);
  }
  set_start(arguments, truth, drive, config);
  output::WatchedLog log(arguments.logs, "localise");
  const Localised out = arguments.recorded ? said_live(log) : localise(log, filter_of(arguments, recorded), config);
  if (out.poses.empty() && arguments.recorded) throw std::runtime_error(arguments.logs[0] + ": has no LOCALIZED_POSE");
  if (out.poses.empty()) throw std::runtime_error(arguments.logs[0] + ": gives no pose: LIDAR_POINTS, IMU and WHEELS?");
  const auto lost = std::count_if(out.poses.begin(), out.poses.end(),
                                  [](const map_pose_t& pose) { return (pose.flags & map_pose_t::LOST) != 0; });
  fmt::print("{} revolutions on {}, {} of them lost", out.poses.size(), arguments.map, lost);
  if (!arguments.recorded)
    fmt::print("; {:.2f} ms each (p50), {:.2f} (p99)", 1e3 * out.report.latency_p50, 1e3 * out.report.latency_p99);
  fmt::print("\n");
  if (!arguments.recorded)
    fmt::print("  configuration: {}\n", recording::source_of_configuration({"ekf", "localizer"}, arguments.config,
                                                                           recorded, arguments.assignments));
  for (const std::string& fault : out.report.faults) fmt::print("  at the end: {}\n", fault);
  nlohmann::json figures = {{"revolutions", out.poses.size()}, {"lost", lost}};
  if (truth) {
    const PoseErrors errors = errors_of(out.poses, *truth);
    fmt::print("{}", to_table(errors));
    figures = to_json(errors);
  }
  if (!arguments.recorded)
    figures["revolution_ms"] = {{"p50", 1e3 * out.report.latency_p50}, {"p99", 1e3 * out.report.latency_p99}};
  if (!arguments.csv.empty()) output::write_text(arguments.csv, to_csv(out.poses));
  if (!arguments.picture.empty()) draw_drive(arguments.map, out.poses, arguments.picture);
  if (!arguments.json.empty()) output::write_text(arguments.json, json_text(figures, 2) + "\n");
  return log.damaged() ? 1 : 0;
}

}  // namespace

int run_localise(int argc, char** argv) {
  Arguments arguments;
  CommandLine line("Places a recorded drive on a saved map, with the vehicle's own nodes", "curbstone localise");
  line.argument("map", arguments.map, "The map, as curbstone-semantic-map or curbstone replay wrote it").required();
  line.option("--log", arguments.logs, "Logs of lcm-logger with LIDAR_POINTS, IMU and WHEELS, or a session's folder")
      .required();
  line.option("--start", arguments.start,
              "X,Y,YAW in the map, m and rad, where the drive begins; else it is searched for")
      .comma_separated();
  line.option("--config", arguments.config, "The vehicle's YAML file, instead of what the log was recorded with");
  line.option("--set", arguments.assignments, "SECTION.KEY=VALUE, over the file").one_each();
  line.option("--truth", arguments.truth, "Truth folder of the drive: adds its errors");
  line.option("--map-truth", arguments.map_truth, "Truth folder of the drive that made the map, of the same town");
  line.flag("--from-truth", arguments.from_truth, "Begin at the drive's true place");
  line.flag("--recorded", arguments.recorded, "Take the LOCALIZED_POSE that the log has: what was said live");
  line.option("--csv", arguments.csv, "Write each pose");
  line.option("--picture", arguments.picture, "Draw the drive on the map: a PNG");
  line.option("--json", arguments.json, "Write the figures here, for programs");
  if (const auto status = line.read(argc, argv)) return *status;
  arguments.assignments = assignments_for(kSections, arguments.assignments);
  if (arguments.truth.empty() != arguments.map_truth.empty())
    return line.refuse("--truth and --map-truth belong together");
  if (arguments.from_truth && arguments.truth.empty()) return line.refuse("--from-truth needs --truth");
  if (!arguments.start.empty() && arguments.start.size() != 3) return line.refuse("--start: three numbers, X,Y,YAW");
  return run(arguments);
}

}  // namespace curbstone::localise
