#include "tools/bench/voting/voting_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/bench/voting/inputs/street_cloud.hpp"
#include "tools/output/text_file.hpp"

namespace curbstone::bench::voting {

namespace {

using nlohmann::json;

double peak_share(const BatchRow& row, const FmaPeak& peak) {
  return row.flops_per_s() / peak.flops_per_s;
}

void print_batch(const VotingReport& report) {
  fmt::print("\nBatch: votes of every point by every point in reach, and decomposition; PCL: NormalEstimationOMP\n");
  fmt::print("  {:>9} {:>6} {:>6} {:>7} {:>10} {:>10} {:>8} {:>10} {:>12} {:>10}\n", "points", "sigma", "R", "threads",
             "ours ms", "PCL ms", "ratio", "of CPU", "votes/s", "FMA peak");
  for (const BatchRow& row : report.batch) {
    std::string pcl = "-", ratio = "-", of_cpu = "-";
    if (row.pcl) {
      pcl = fmt::format("{:.1f}", row.pcl->wall_ms);
      ratio = fmt::format("{:.1f}x", row.pcl->wall_ms / row.ours.wall_ms);
      of_cpu = fmt::format("{:.1f}x", row.pcl->cpu_ms / row.ours.cpu_ms);
    }
    fmt::print("  {:>9} {:>6.2f} {:>6.2f} {:>7} {:>10.2f} {:>10} {:>8} {:>10} {:>12.3g} {:>8.1f} %\n", row.points,
               row.sigma, row.radius, row.threads, row.ours.wall_ms, pcl, ratio, of_cpu, row.pair_votes_per_s(),
               100 * peak_share(row, report.peak));
  }
}

void print_growth(const VotingReport& report) {
  fmt::print("\nHow the cost grows\n");
  fmt::print("  {:>9} {:>9} {:>9} {:>7} {:>10} {:>12} {:>10}\n", "points", "street m", "per m^2", "threads", "ours ms",
             "us a point", "ns a vote");
  for (const BatchRow& row : report.growth) {
    const auto points = static_cast<double>(row.points);
    fmt::print("  {:>9} {:>9.0f} {:>9.0f} {:>7} {:>10.2f} {:>12.3f} {:>10.3f}\n", row.points, row.length,
               points / (inputs::kStreetArea * row.length), row.threads, row.ours.wall_ms,
               row.ours.wall_ms * 1e3 / points, 1e9 / row.pair_votes_per_s());
  }
}

void print_incremental(const IncrementalTiming& t) {
  fmt::print(
      "\nIncremental: sigma 0.1 m on 5 cm voxels and 0.3 m on 10 cm; {} revolutions, {} points, {} voters, {} "
      "pairs\n",
      t.revolutions, t.points, t.voters, t.pairs);
  fmt::print("  CPU ms a revolution on one core   {:>8} {:>8} {:>8}\n", "mean", "p99", "max");
  const auto line = [](const char* what, const ScanTimes& times) {
    fmt::print("  {:<33} {:>8.2f} {:>8.2f} {:>8.2f}\n", what, times.mean_ms, times.p99_ms, times.max_ms);
  };
  line("its points into both fields", t.voting);
  line("a worker, all of it", t.worker);
  fmt::print("  of which changed tiles into VOTED_POINTS: {:.2f} on average\n", t.decomposition_ms);
  fmt::print("  newest points of a tile to its VOTED_POINTS, by pacing alone: p50 {:.0f} ms, p95 {:.0f} ms\n",
             t.pacing_p50_ms, t.pacing_p95_ms);
  fmt::print("  largest difference to the batch vote of the same points: {:.1e} of the tensor's norm\n",
             t.max_relative_difference);
  if (!t.cuda) return;
  fmt::print("  On the GPU, wall ms a revolution  {:>8} {:>8} {:>8}\n", "mean", "p99", "max");
  line("its points into both fields", t.cuda->add);
  line("the changed tiles' votes", t.cuda->votes);
  fmt::print("  {} of {} voters have other bits than on the CPU\n", t.cuda->different, t.cuda->compared);
}

json batch_json(const VotingReport& report) {
  json rows = json::array();
  for (const BatchRow& row : report.batch) {
    json& out = rows.emplace_back(json{{"points", row.points},
                                       {"sigma", row.sigma},
                                       {"radius", row.radius},
                                       {"threads", row.threads},
                                       {"ours_ms", row.ours.wall_ms},
                                       {"pcl_ms", nullptr},
                                       {"ratio", nullptr},
                                       {"pair_votes_per_s", row.pair_votes_per_s()},
                                       {"fma_peak_share", peak_share(row, report.peak)},
                                       {"ours_cpu_ms", row.ours.cpu_ms},
                                       {"pcl_cpu_ms", nullptr}});
    if (!row.pcl) continue;
    out["pcl_ms"] = row.pcl->wall_ms;
    out["ratio"] = row.pcl->wall_ms / row.ours.wall_ms;
    out["pcl_cpu_ms"] = row.pcl->cpu_ms;
  }
  return rows;
}

json growth_json(const VotingReport& report) {
  json rows = json::array();
  for (const BatchRow& row : report.growth) {
    rows.push_back({{"points", row.points},
                    {"street_m", row.length},
                    {"points_per_m2", static_cast<double>(row.points) / (inputs::kStreetArea * row.length)},
                    {"threads", row.threads},
                    {"ours_ms", row.ours.wall_ms},
                    {"pair_votes_per_s", row.pair_votes_per_s()}});
  }
  return rows;
}

json cuda_growth_json(const CudaGrowth& t) {
  return {{"add_mean_ms", t.add.mean_ms},   {"add_p99_ms", t.add.p99_ms},
          {"add_max_ms", t.add.max_ms},     {"votes_mean_ms", t.votes.mean_ms},
          {"votes_p99_ms", t.votes.p99_ms}, {"votes_max_ms", t.votes.max_ms},
          {"voters", t.compared},           {"different_voters", t.different}};
}

json incremental_json(const IncrementalTiming& t) {
  return {{"mean_ms", t.voting.mean_ms},
          {"p99_ms", t.voting.p99_ms},
          {"max_ms", t.voting.max_ms},
          {"max_relative_difference", t.max_relative_difference},
          {"revolutions", t.revolutions},
          {"points", t.points},
          {"voters", t.voters},
          {"pairs", t.pairs},
          {"worker_mean_ms", t.worker.mean_ms},
          {"worker_p99_ms", t.worker.p99_ms},
          {"worker_max_ms", t.worker.max_ms},
          {"decomposition_ms", t.decomposition_ms},
          {"pacing_p50_ms", t.pacing_p50_ms},
          {"pacing_p95_ms", t.pacing_p95_ms},
          {"cuda", t.cuda ? cuda_growth_json(*t.cuda) : json(nullptr)}};
}

}  // namespace

void print_report(const VotingReport& report) {
  fmt::print("Tensor voting, kernel {}; FMA peak {:.0f} GFLOP/s ({}), a vote counted as {:.0f} flops\n", report.kernel,
             report.peak.flops_per_s * 1e-9, report.peak.isa, kFlopsPerVote);
  if (!report.batch.empty()) print_batch(report);
  if (!report.growth.empty()) print_growth(report);
  if (!report.batch.empty()) print_cuda(report.cuda);
  fmt::print("\nSum of l1 - l2 over 10,000 points: {:.1f}; independent codes, another draw: {:.1f} ({:+.1f} %)\n",
             report.stick_sum, kStickSumOfOthers, 100 * (report.stick_sum / kStickSumOfOthers - 1));
  if (report.incremental) print_incremental(*report.incremental);
}

void write_report(const VotingReport& report, const std::string& file) {
  const json all = {{"kernel", report.kernel},
                    {"batch", batch_json(report)},
                    {"incremental", report.incremental ? incremental_json(*report.incremental) : json(nullptr)},
                    {"cuda", cuda_json(report.cuda)},
                    {"growth", growth_json(report)},
                    {"fma_peak_flops_per_s", report.peak.flops_per_s},
                    {"stick_sum", report.stick_sum}};
  output::write_text(file, all.dump(2) + '\n');
}

}  // namespace curbstone::bench::voting
