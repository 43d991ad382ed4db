#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/bus/levels.hpp"
#include "common/config/config.hpp"
#include "services/mapper/journal/journal_file.hpp"
#include "services/mapper/journal/local_map_file.hpp"
#include "services/mapper/mapper_node.hpp"
#include "services/mapper/storage/map_folder.hpp"

/// @file
/// MapperNode: the map and the drive on disk.

namespace curbstone::mapper {
namespace {

constexpr std::int64_t kRewind = 3'000'000;  // us of the drive that are mapped again at most, for the local map's sake
constexpr std::int64_t kMissing = 200'000;   // us of the drive that are worth a fault: four revolutions

std::size_t journal_bytes(const config::MapperConfig& config) {
  return static_cast<std::size_t>(config.journal_mb * 1e6);
}

std::string journal_hash(const config::MapperConfig& mapper) {
  ConfigOf<config::MapperConfig> config;
  config.value = mapper;
  return config_hash("mapper", config);
}

}  // namespace

/// Loads the map of an earlier drive.
void MapperNode::begin_map() {
  const storage::SavedMap map =
      storage::load_map(config_.folder, {[this](const storage::SavedTile& tile) { mapper_->load(tile); },
                                         [this](scan::Keyframe node) { mapper_->load(std::move(node)); }});
  if (std::abs(map.voxel - config_.dense.voxel) > 1e-9) {
    throw storage::MapFolderError(fmt::format("{}: its voxels are {} m, those of the configuration {}", config_.folder,
                                              map.voxel, config_.dense.voxel));
  }
  if (mapper_->atlas().size() == 0)
    throw storage::MapFolderError(config_.folder + ": holds no nodes to find the vehicle by");
  epoch_before_ = map.epoch;
  mapper_->load(map);
  if (saver_) saver_->set_loaded(mapper_->snapshot(map.epoch, {}).versions);
}

void MapperNode::open_journal() {
  journal_.emplace(config_.journal, journal_bytes(config_), journal_hash(config_));
}

/// The time from which on the drive is mapped again, us: before what had not settled in the dense map, and not later
/// than the local map, which must not lack scans. A local map that is too old for that is dropped.
std::int64_t MapperNode::resume_after(journal::RecordedDrive& drive) const {
  const std::int64_t last = drive.poses.back().utime;
  const std::int64_t settled = last - std::llround(1e6 * config_.dense.settled_after());
  if (drive.local_map && drive.local_map->utime < last - kRewind) drive.local_map.reset();
  return drive.local_map ? std::min(settled, drive.local_map->utime) : settled;
}

/// Continues the drive of a mapper that was killed a short time ago. True if there is one.
bool MapperNode::resume_drive() {
  if (config_.journal.empty()) return false;
  open_journal();
  const std::optional<double> age = journal::age_of_journal(config_.journal);
  if (!age) return false;
  if (std::abs(*age) > config_.resume_within_s) {
    counters_.add("journal.old");
    return false;
  }
  try {
    std::optional<journal::RecordedDrive> drive =
        journal::read_journal(config_.journal, journal_bytes(config_), journal_hash(config_), spill_file_.get());
    if (!drive) return false;
    epoch_before_ = drive->epoch;
    drive->local_map = journal::read_local_map(journal_->local_map().path(), journal_hash(config_), drive->epoch);
    journal::drop_poses_after(resume_after(*drive), drive->poses);
    resumed_drive_ = drive->poses;
    resumed_from_ = drive->poses.back().utime;
    input_.begin_at(resumed_from_);
    journal_->adopt(*drive);
    mapper_->resume(std::move(*drive));
    return true;
  } catch (const journal::JournalError& error) {
    counters_.add("journal.refused");
    why_new_map_ = fmt::format("a new map begins: {}", error.what());
    return false;
  }
}

/// The first scan after resume_drive() shows whether the sensors' messages since then were sent again.
void MapperNode::note_missing(const scan::Scan& scan) {
  const std::int64_t missing = scan.start - std::exchange(resumed_from_, 0);
  if (missing < kMissing) return;
  missing_ = Missing{missing, scan.end};
  counters_.add("resumed.missing_ms", missing / 1000);
}

/// Begins the journal of the present epoch: the drive has the poses so far.
void MapperNode::journal_epoch(const std::vector<journal::RecordedPose>& drive, bool is_rearranged) {
  if (!journal_) return;
  const bool continues = !is_rearranged && !drive.empty() &&
                         journal_->continue_epoch(epoch_, drive.back().utime, mapper_->grown(), mapper_->atlas());
  if (!continues) journal_->start_epoch(epoch_, drive);
}

/// Faults of the file of far tiles, of the map's folder and of the journal.
void MapperNode::add_disk_faults(std::vector<std::string>& faults) const {
  if (!spill_file_->read_fault().empty())
    faults.push_back(
        fmt::format("far tiles: {} of them cannot be read, so they cannot be sent, saved or grow; they are tried "
                    "again: {}",
                    spill_file_->unreadable(), spill_file_->read_fault()));
  if (const std::int64_t evicted = mapper_->counters()["dense.evicted_tiles"]; evicted > 0)
    faults.push_back(
        fmt::format("far tiles: {} were dropped, as memory holds no more than dense.max_points and no disk takes them: "
                    "they stay as they were published and saved before, and grow no more",
                    evicted));
  if (!spill_file_->fault().empty()) faults.push_back("far tiles stay in memory: " + spill_file_->fault());
  if (saver_ && !saver_->fault().empty()) faults.push_back(saver_->fault());
  if (journal_ && !journal_->fault().empty()) faults.push_back(journal_->fault());
  if (!why_new_map_.empty() && last_end_ - input_.first_start() < kReportedFor) faults.push_back(why_new_map_);
  if (missing_.time > 0 && last_end_ - missing_.since < kReportedFor)
    faults.push_back(
        fmt::format("{:.1f} s of the drive are missing: this mapper was started for one that died, and nobody sent "
                    "again what the sensors measured in between",
                    static_cast<double>(missing_.time) * 1e-6));
}

/// Begins another map in a frame of its own. The earlier map stays on disk in a renamed folder, and semantic_map keeps
/// its file.
void MapperNode::begin_new_drive(const std::string& why) {
  if (saver_ && saver_->busy()) return;  // the next scan tries again
  counters_.add("new_drives");
  const Counters method = mapper_->counters();
  for (const auto& [name, value] : method.values()) {
    if (!is_level(name)) counters_.add(name, value);
  }
  why_new_map_ = "a new map begins: " + why;
  if (saver_) {
    (void)mapper_->finish();
    const std::vector<TrajectoryPoint> drive = mapper_->trajectory();
    const std::int64_t began = drive.empty() ? last_end_ : drive.front().utime;
    const auto beside = saver_->set_aside(mapper_->snapshot(epoch_, saver_->on_disk()), began);
    why_new_map_ += fmt::format("; the earlier one stays in {}", beside.string());
  }
  mapper_.emplace(config_, spill_file_);
  sensor_monitor_.begin_map();
  sensor_monitor_.interrupt();
  epoch_before_ = std::exchange(epoch_, 0);
  resumed_drive_.clear();
  start_drive_.clear();
  input_.begin_drive(last_end_);
}

/// Begins the map again with vehicle.lidar corrected. A mapper that continued the drive would not know it, so the
/// journal is that of another configuration.
void MapperNode::begin_with_other_lidar(const std::string& why) {
  config_.vehicle.lidar = lidar_at_start_.lidar();
  if (saver_) saver_->finish();
  begin_new_drive(why);
  sensor_monitor_ = detection::SensorMonitor(config_.vehicle);
  if (journal_) open_journal();
}

/// Saves the map every `save_every` of message time. Only changes are copied here; another thread writes them.
void MapperNode::keep_map() {
  if (!saver_ || !saver_->is_due(last_end_)) return;
  if (mapper_->grown().is_moving()) return;  // the map is incomplete
  saver_->schedule_after(last_end_);
  mapper_->wait();
  saver_->begin(mapper_->snapshot(epoch_, saver_->on_disk()));
}

void MapperNode::keep_map_at_the_end() {
  if (!saver_) return;
  saver_->finish();
  saver_->begin(mapper_->snapshot(epoch_, saver_->on_disk()));
  saver_->finish();
}

}  // namespace curbstone::mapper
