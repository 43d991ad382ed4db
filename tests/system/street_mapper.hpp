#pragma once

#include <Eigen/Core>
#include <map>
#include <random>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/tile_sync/tile_sync.hpp"
#include "common/tiles/tile.hpp"
#include "tests/services/tensor_voting/clouds.hpp"

namespace curbstone::system_test {

/// A mapper on the bus without the sensors and the registration: a vehicle drives down a street at 3 m/s, and every
/// revolution adds 2500 points of what is within 10 m of it. It announces its tiles and answers requests as the mapper
/// does.
class StreetMapper {
 public:
  static constexpr std::int32_t kEpoch = 7;

  StreetMapper(Subscriber& bus, Publisher& publisher);

  /// `now`: wall clock, us. While `driving`, ten revolutions a second.
  void tick(std::int64_t now, bool driving);

  /// All that has been mapped.
  [[nodiscard]] const test_clouds::Tiles& tiles() const { return tiles_; }

 private:
  void map_scan(std::int64_t now);
  void send(std::int64_t now, TileKey key, std::size_t first);

  Publisher& publisher_;
  TileCatalog catalog_{"mapper", "MAP_POINTS"};
  test_clouds::Tiles tiles_;
  unsigned scan_ = 0;
  double x_ = 0;  // m, of the vehicle
  std::int64_t last_scan_ = 0;
  std::int64_t last_index_ = 0;
};

}  // namespace curbstone::system_test
