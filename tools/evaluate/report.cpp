#include "tools/evaluate/report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/json/json_text.hpp"

namespace curbstone::evaluate {

namespace {

std::string trajectory_table(const truth::TrajectoryErrors& t) {
  return fmt::format("trajectory   {:.1f} m driven   ATE {:.3f} m   RPE {:.2f} %, {:.3f} deg/m   end {:.2f} %\n",
                     t.distance_m, t.ate_m, t.rpe_percent, t.rpe_deg_per_m, t.end_percent);
}

std::string recall_by_step(const CurbScore& c) {
  std::string text;
  for (std::size_t i = 0; i < c.by_step.size(); ++i) {
    const auto [points, found] = c.by_step[i];
    if (points == 0) continue;
    const std::string range = i < kStepBounds.size() ? fmt::format("<= {:.0f} cm", 100 * kStepBounds[i])
                                                     : fmt::format("> {:.0f} cm", 100 * kStepBounds.back());
    text += fmt::format("   {} {:.2f}", range, static_cast<double>(found) / points);
  }
  return text;
}

std::string curb_table(const CurbScore& c) {
  std::string text = "curbs        tolerance   precision   recall       F1\n";
  for (std::size_t i = 0; i < kTolerances.size(); ++i) {
    text += fmt::format("             {:6.2f} m   {:9.3f}   {:6.3f}   {:6.3f}\n", kTolerances[i], c.at[i].precision,
                        c.at[i].recall, c.at[i].f1());
  }
  text +=
      fmt::format("             {} curb cells; not counted: {} at lowered kerbs, {} beyond the truth; {} true points\n",
                  c.detections, c.on_dropped, c.beyond_truth, c.true_points);
  text += fmt::format("             recall at {:.2f} m: of what was seen {:.3f}; by step{}\n", kTolerances.back(),
                      c.recall_of_seen, recall_by_step(c));
  text += fmt::format("             lowered kerbs: {} of {} true points marked; {} of {} marked points are none\n",
                      c.lowered_found, c.lowered_points, c.lowered_wrong, c.lowered_feet);
  if (c.inferred_m > 0) {
    text += fmt::format(
        "             inferred, not counted above: {:.1f} m, {:.3f} of them right; {} of {} missed points\n",
        c.inferred_m, c.inferred_right, c.inferred_found, c.missed.size());
  }
  text += fmt::format(
      "             lateral error of the foot: median {:.1f} cm, p95 {:.1f} cm; bias {:+.1f} cm to the high side, "
      "spread {:.1f} cm\n",
      c.lateral_median_cm, c.lateral_p95_cm, c.lateral_bias_cm, c.lateral_spread_cm);
  return text;
}

std::string class_table(const Confusion& classes) {
  static constexpr std::array kNames = {"unknown", "road", "curb", "obstacle", "wall"};
  std::string text = fmt::format("classes      accuracy {:.3f} of {} known cells; truth down, map across\n",
                                 classes.accuracy(), classes.total());
  text += fmt::format("             {:>10}", "");
  for (std::size_t column = 1; column < semantic_map::tile::kNumClasses; ++column)
    text += fmt::format("{:>10}", kNames[column]);
  for (std::size_t row = 1; row < semantic_map::tile::kNumClasses; ++row) {
    text += fmt::format("\n             {:>10}", kNames[row]);
    for (std::size_t column = 1; column < semantic_map::tile::kNumClasses; ++column)
      text += fmt::format("{:>10}", classes.count[row][column]);
  }
  return text + "\n";
}

std::string blocking_table(const BlockingScore& b) {
  return fmt::format(
      "obstacles    and walls near the path: recall {:.4f}, {} of their cells called free; {} of {} that points fell "
      "into are unknown\n",
      b.recall(), b.free(), b.unknown, b.blocked + b.free() + b.unknown);
}

/// One line: the sum, and the share of each process. Empty without processes.
std::string of_processes(const char* all, const char* each, const std::map<std::string, double>& values) {
  if (values.empty()) return "";
  double sum = 0;
  std::string text;
  for (const auto& [service, value] : values) {
    text += fmt::format(fmt::runtime(each), service, value);
    sum += value;
  }
  return fmt::format(fmt::runtime(all), sum) + text + "\n";
}

std::string run_table(const RunFigures& run) {
  std::string text = run.processes == 0
                         ? "losses       not known: no SERVICE_STATUS in the recording\n"
                         : fmt::format("losses       {} packets, {} messages\n", run.lost_packets, run.lost_messages);
  for (const auto& [channel, missing] : run.lost_by_recorder)
    text += fmt::format("             {} {} are not in the recording: a replay will differ\n", missing, channel);
  for (const auto& [name, value] : run.losses) text += fmt::format("             {} {}\n", name, value);
  if (run.latency) {
    const RunFigures::Latency& tiles = *run.latency;
    text += fmt::format(
        "latency      measurement to tile: p50 {:.0f} ms, p95 {:.0f} ms, p99 {:.0f} ms, at most {:.0f} ms"
        " ({} tiles)\n",
        tiles.p50_ms, tiles.p95_ms, tiles.p99_ms, tiles.max_ms, tiles.messages);
    for (const auto& [channel, stage] : run.stages)
      text += fmt::format("             to {}: p50 {:.0f} ms, p95 {:.0f} ms\n", channel, stage.p50_ms, stage.p95_ms);
  }
  if (!run.first_after_s.empty()) {
    text += "start        s after the first LIDAR_POINTS:";
    for (const auto& [channel, seconds] : run.first_after_s) text += fmt::format(" {} {:.2f}", channel, seconds);
    if (run.set_off_after_s) text += fmt::format("   set off {:.2f}", *run.set_off_after_s);
    text += "\n";
  }
  text += of_processes("cores        {:.2f} in all:", "   {} {:.2f}", run.cores);
  text +=
      of_processes("memory       {:.0f} MB resident in all, files that several share counted in each:", "   {} {:.0f}",
                   run.memory_mb);
  text += of_processes("             {:.0f} MB without files:", "   {} {:.0f}", run.own_memory_mb);
  text += of_processes("             {:.0f} MB without files a minute after the start:", "   {} {:.0f}",
                       run.own_memory_after_a_minute_mb);
  return text;
}

nlohmann::json curb_json(const CurbScore& c) {
  nlohmann::json json;
  for (std::size_t i = 0; i < kTolerances.size(); ++i) {
    json[fmt::format("{:.2f}", kTolerances[i])] = {
        {"precision", c.at[i].precision}, {"recall", c.at[i].recall}, {"f1", c.at[i].f1()}};
  }
  return json;
}

void add_curbs(const CurbScore& c, nlohmann::json& json) {
  json["curb"] = curb_json(c);
  json["lowered_kerbs"] = {{"true_points", c.lowered_points},
                           {"found", c.lowered_found},
                           {"marked_points", c.lowered_feet},
                           {"wrong", c.lowered_wrong}};
  json["inferred"] = {{"length_m", c.inferred_m},
                      {"right", c.inferred_right},
                      {"missed_points", c.missed.size()},
                      {"found", c.inferred_found}};
  json["lateral_cm"] = {{"median", c.lateral_median_cm},
                        {"p95", c.lateral_p95_cm},
                        {"bias", c.lateral_bias_cm},
                        {"spread", c.lateral_spread_cm}};
}

nlohmann::json blocking_json(const BlockingScore& b) {
  return {{"recall", b.recall()}, {"blocked", b.blocked}, {"free", b.free()}, {"unknown", b.unknown}};
}

nlohmann::json trajectory_json(const truth::TrajectoryErrors& t) {
  return {{"distance_m", t.distance_m},
          {"ate_m", t.ate_m},
          {"rpe_percent", t.rpe_percent},
          {"rpe_deg_per_m", t.rpe_deg_per_m},
          {"end_percent", t.end_percent}};
}

nlohmann::json dropped_json(const RunFigures& run) {
  std::int64_t by_recorder = 0;
  for (const auto& [channel, missing] : run.lost_by_recorder) by_recorder += missing;
  return {{"packets", run.lost_packets},
          {"messages", run.lost_messages},
          {"by_recorder", by_recorder},
          {"by_recorder_channels", run.lost_by_recorder}};
}

nlohmann::json latency_json(const RunFigures::Latency& latency) {
  return {{"p50", latency.p50_ms}, {"p95", latency.p95_ms}, {"p99", latency.p99_ms}, {"max", latency.max_ms}};
}

void add_run(const RunFigures& run, nlohmann::json& json) {
  if (run.processes > 0) json["dropped"] = dropped_json(run);
  if (run.latency) {
    json["latency_ms"] = latency_json(*run.latency);
    for (const auto& [channel, stage] : run.stages) json["latency_ms"]["stages"][channel] = latency_json(stage);
  }
  if (!run.first_after_s.empty()) json["start_s"] = run.first_after_s;
  if (run.set_off_after_s) json["start_s"]["set_off"] = *run.set_off_after_s;
  if (!run.cores.empty()) json["cores"] = run.cores;
  for (const auto& [process, share] : run.cores) {
    nlohmann::json of_process = {{"name", process}, {"cores", share}, {"memory_mb", run.memory_mb.at(process)}};
    if (const auto own = run.own_memory_mb.find(process); own != run.own_memory_mb.end())
      of_process["own_memory_mb"] = own->second;
    if (const auto minute = run.own_memory_after_a_minute_mb.find(process);
        minute != run.own_memory_after_a_minute_mb.end())
      of_process["own_memory_after_a_minute_mb"] = minute->second;
    json["processes"].push_back(std::move(of_process));
  }
}

}  // namespace

std::string to_table(const Evaluation& e) {
  std::string text = trajectory_table(e.trajectory);
  if (e.curbs) text += curb_table(*e.curbs);
  if (e.classes) text += class_table(*e.classes);
  if (e.firm_classes)
    text +=
        fmt::format("             accuracy {:.3f} of the {} cells whose class does not hang on 2 cm at their edges\n",
                    e.firm_classes->accuracy(), e.firm_classes->total());
  if (e.blocking) text += blocking_table(*e.blocking);
  if (e.run) text += run_table(*e.run);
  return text;
}

std::string to_json(const Evaluation& e) {
  nlohmann::json json;
  for (const char* key : {"curb", "lowered_kerbs", "inferred", "lateral_cm", "classes", "blocking", "dropped",
                          "latency_ms", "start_s", "cores", "processes"})
    json[key] = nullptr;
  if (e.curbs) add_curbs(*e.curbs, json);
  if (e.classes) json["classes"] = {{"accuracy", e.classes->accuracy()}, {"confusion", e.classes->count}};
  if (e.firm_classes) {
    json["classes"]["firm_accuracy"] = e.firm_classes->accuracy();
    json["classes"]["firm_confusion"] = e.firm_classes->count;
  }
  if (e.blocking) json["blocking"] = blocking_json(*e.blocking);
  json["trajectory"] = trajectory_json(e.trajectory);
  if (e.run) add_run(*e.run, json);
  return json_text(json, 2) + "\n";
}

}  // namespace curbstone::evaluate
