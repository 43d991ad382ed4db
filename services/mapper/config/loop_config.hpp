#pragma once

#include "common/config/config.hpp"

namespace curbstone::mapper::config {

/// Settings of loop closure.
struct LoopConfig {
  bool close = true;
  double look_every = 2.0;
  double search = 3.0;
  double search_drift = 0.01;
  double max_search = 15.0;
  double agree_m = 0.3;
  double agree_rad = 0.03;
  double within = 15.0;
  double max_sigma = 5.0;
  double rearrange_m = 0.03;

  void visit(ConfigVisitor& v) {
    v.field("close", close, "whether loops are closed");
    v.field("look_every", look_every, {0.5, 100.0}, "m driven between two searches for a loop");
    v.field("search", search, {0.5, 15.0}, "m, search radius around the expected place");
    v.field("search_drift", search_drift, {0.0, 0.2}, "m, increase of that radius for each m driven since");
    v.field("max_search", max_search, {0.5, 15.0}, "m, largest search radius");
    v.field("agree_m", agree_m, {0.01, 5.0}, "m to which two consecutive searches must agree");
    v.field("agree_rad", agree_rad, {0.001, 1.0}, "rad, likewise");
    v.field("within", within, {1.0, 100.0}, "m driven between these two searches, at most");
    v.field("max_sigma", max_sigma, {1.0, 100.0}, "sigmas by which a loop may bend an edge of the graph");
    v.field("rearrange_m", rearrange_m, {0.0, 1.0}, "m that a keyframe must move for the map to be rearranged");
  }
};

}  // namespace curbstone::mapper::config
