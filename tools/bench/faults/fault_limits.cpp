#include "tools/bench/faults/fault_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace curbstone::bench::faults {

namespace {

/// Cells by which two undisturbed drives differ, for each second driven: the largest of all lengths, since some are
/// driven only once.
double spread(const FaultReport& report) {
  double spread = 0;
  for (const Undisturbed& drive : report.undisturbed) {
    if (!drive.is_spoiled()) spread = std::max(spread, drive.live_cells_differ / drive.seconds);
  }
  for (const FaultRow& row : report.rows) {
    if (row.is_undisturbed && row.cells_differ) spread = std::max(spread, *row.cells_differ / row.seconds);
  }
  return spread;
}

bool is_judged(const FaultRow& row) {
  return !row.is_spoiled() && row.cells_differ && row.poses_missing;
}

}  // namespace

std::vector<std::string> broken_limits(const FaultReport& report) {
  const double most_a_second = kMaxSpreads * spread(report);
  std::vector<std::string> broken;
  for (const FaultRow& row : report.rows) {
    const auto breaks = [&](const std::string& what) { broken.push_back(fmt::format("{}: {}", row.fault, what)); };
    if (row.map != "ok") breaks("the map file: " + row.map);
    if (!row.ended_cleanly) breaks("not all processes ended by themselves");
    if (!is_judged(row) || row.excuse.covers == Excuse::Covers::kAll) continue;
    const long most = std::lround(most_a_second * row.seconds);
    if (*row.cells_differ > most && !row.is_undisturbed)
      breaks(fmt::format("{} cells differ, more than {}", *row.cells_differ, most));
    if (*row.poses_missing > 0) breaks(fmt::format("{} poses are missing", *row.poses_missing));
    if (row.excuse.covers == Excuse::Covers::kTime) continue;
    if (!row.back_s)
      breaks("not back before the end");
    else if (*row.back_s > kBackWithin)
      breaks(fmt::format("back after {:.1f} s, more than {:.1f}", *row.back_s, kBackWithin));
  }
  return broken;
}

std::vector<std::string> unjudged(const FaultReport& report) {
  std::vector<std::string> rows;
  for (const FaultRow& row : report.rows) {
    if (!is_judged(row)) rows.push_back(row.fault);
  }
  return rows;
}

}  // namespace curbstone::bench::faults
