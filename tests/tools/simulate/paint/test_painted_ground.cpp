#include "tools/simulate/paint/painted_ground.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/tools/simulate/drives.hpp"
#include "tools/simulate/sensors/lidar_model.hpp"
#include "tools/simulate/town_surroundings.hpp"

namespace curbstone::simulate::paint {
namespace {

using world::Surface;

const PaintedGround& ground(Paint paint) {
  static const PaintedGround none(test_town(), Paint::kNone), fresh(test_town(), Paint::kFresh),
      worn(test_town(), Paint::kWorn);
  return paint == Paint::kNone ? none : paint == Paint::kFresh ? fresh : worn;
}

/// Reflectivity in the middle of every piece, ascending.
std::vector<float> on_markings(Paint paint) {
  std::vector<float> values;
  for (const Marking& marking : ground(Paint::kFresh).markings()) {
    for (const MarkingPiece& piece : marking.pieces) {
      for (std::size_t i = 0; i + 1 < piece.centre.size(); ++i) {
        const Eigen::Vector2f p = (0.5 * (piece.centre[i] + piece.centre[i + 1])).cast<float>();
        values.push_back(ground(paint).at(p.x(), p.y(), Surface::kAsphalt));
      }
    }
  }
  std::sort(values.begin(), values.end());
  return values;
}

TEST(PaintedGround, IsAsBrightAsItsPaint) {
  const auto fresh = on_markings(Paint::kFresh), worn = on_markings(Paint::kWorn), none = on_markings(Paint::kNone);
  ASSERT_GT(fresh.size(), 500U);
  EXPECT_FLOAT_EQ(fresh.front(), 0.55F);
  EXPECT_FLOAT_EQ(fresh.back(), 0.55F);
  EXPECT_NEAR(worn[worn.size() / 2], 0.29, 0.04);
  const auto holes = std::count_if(worn.begin(), worn.end(), [](float value) { return value < 0.25F; });
  EXPECT_NEAR(static_cast<double>(holes) / static_cast<double>(worn.size()), 0.25, 0.1);
  EXPECT_NEAR(none[none.size() / 2], 0.14, 0.02);
  EXPECT_LT(none.front(), 0.03F) << "tar";
  EXPECT_TRUE(ground(Paint::kNone).markings().empty());
}

TEST(PaintedGround, HasABrighterPavementThanRoad) {
  EXPECT_GT(ground(Paint::kNone).at(3.2F, 7.7F, Surface::kPavement), 0.2F);
}

TEST(PaintedGround, ChangesTheIntensityOfAReturnAndNothingElse) {
  TownSurroundings plain(test_town(), {}), painted(test_town(), {}, ground(Paint::kFresh), {});
  int others = 0;
  for (const double azimuth : {0.0, 1.5, 3.0, 4.5}) {
    const Pose T = test_motion().T_world_base(10) * VehicleConfig{}.T_base_lidar();
    const sensors::PacketView view{10.0, T, azimuth, 0.1};
    plain.prepare(view);
    painted.prepare(view);
    for (int i = 0; i < 400; ++i) {
      const double a = azimuth + 0.001 * i, down = -0.05 - 0.0005 * i;
      const Eigen::Vector3d way = T.linear() * Eigen::Vector3d(std::cos(a), -std::sin(a), down).normalized();
      const sensors::Shot shot{
          10.0, i % 16, a, T.translation(), way, numerics::mix_bits(static_cast<std::uint64_t>(i))};
      const devices::LidarShot before = plain.measure(shot), after = painted.measure(shot);
      EXPECT_EQ(before.range_m, after.range_m);
      others += before.intensity != after.intensity ? 1 : 0;
    }
  }
  EXPECT_GT(others, 1000);
}

}  // namespace
}  // namespace curbstone::simulate::paint
