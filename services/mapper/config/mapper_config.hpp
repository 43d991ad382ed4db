#pragma once

#include <string>

#include "common/config/config.hpp"
#include "common/config/vehicle.hpp"
#include "services/mapper/config/atlas_config.hpp"
#include "services/mapper/config/dense_config.hpp"
#include "services/mapper/config/loop_config.hpp"
#include "services/mapper/config/map_mode.hpp"
#include "services/mapper/config/registration_config.hpp"
#include "services/mapper/config/tracker_config.hpp"

namespace curbstone::mapper::config {

/// The mapper's settings; the defaults suit an RS-LiDAR-16 on a vehicle. visit() documents the meaning and the unit of
/// each. In a file, the keys of `tracker` and `registration` are at the same level as the mapper's own.
struct MapperConfig {
  int threads = 2;
  MapMode mode = MapMode::kMap;
  std::string folder;
  double save_every = 60.0;
  std::string journal;
  double journal_mb = 1000.0;
  double resume_within_s = 20.0;
  std::string far_folder = "/var/tmp";
  double keep_free = 1.0;
  double start_x = 0;
  double start_y = 0;
  double start_yaw = 0;
  double start_radius = 5.0;
  double odometry_wait_s = 1.0;
  double start_wait_s = 2.0;
  TrackerConfig tracker;
  VehicleConfig vehicle;
  RegistrationConfig registration;
  AtlasConfig atlas;
  LoopConfig loop;
  DenseConfig dense;

  void visit(ConfigVisitor& v) {
    v.field("threads", threads, {1, 2}, "2: the dense map is updated in a second thread, parallel to registration");
    v.choice("mode", mode, {{"map", MapMode::kMap}, {"extend", MapMode::kExtend}, {"localise", MapMode::kLocalise}},
             "begin a new map in `folder`, extend the one there, or only localise in it");
    v.field("folder", folder, "folder of the map on disk, written during the drive and at its end; empty: none");
    v.field("save_every", save_every, {0.0, 86400.0}, "s between two saves; 0: only at the end");
    v.field("journal", journal,
            "file from which the next mapper continues the drive if this one is killed; empty: none");
    v.field("journal_mb", journal_mb, {1.0, 100000.0},
            "MB, largest size of the journal; a town takes 0.17 per metre of new ground");
    v.field("resume_within_s", resume_within_s, {1.0, 600.0}, "s, age beyond which a journal is not continued");
    v.field("far_folder", far_folder,
            "folder on a disk, for an unnamed file with what is far from the vehicle; empty: kept in memory, packed");
    v.field("keep_free", keep_free, {0.0, 1e6}, "GB of that disk that stay free; beyond that far tiles stay in memory");
    v.field("start_x", start_x, {-1e6, 1e6}, "m, start position in that map");
    v.field("start_y", start_y, {-1e6, 1e6}, "m");
    v.field("start_yaw", start_yaw, {-7.0, 7.0}, "rad");
    v.field("start_radius", start_radius, {0.0, 1e6},
            "m, uncertainty of the start position; the vehicle is searched for within it");
    v.field("odometry_wait_s", odometry_wait_s, {0.02, 5.0},
            "s of lidar time that a scan waits for odometry; after a wait in vain 0.25 at most, until it is back");
    v.field("start_wait_s", start_wait_s, {0.02, 60.0}, "s of lidar time that the first scan waits for odometry");
    tracker.visit(v);
    v.section("vehicle", vehicle, "shared: the vehicle");
    registration.visit(v);
    v.section("atlas", atlas, "the keyframes of the drive");
    v.section("loop", loop, "closing loops");
    v.section("dense", dense, "the dense map");
  }
};

}  // namespace curbstone::mapper::config
