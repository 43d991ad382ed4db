#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace curbstone::simulate::world {

/// The surface that a ray hit. The kinds of ground come first.
enum class Surface : std::uint8_t {
  kNone,
  kAsphalt,
  kCurbStone,
  kPavement,
  kGrass,
  kWall,
  kFence,
  kFoliage,
  kTrunk,
  kPole,
  kCar,
  kBin
};

/// The cross-section of every street, from the crown over the curb to the gardens. The rays, the vehicle's wheels and
/// the truth use the same height function.
struct StreetProfile {
  double steepness = 0.04;      ///< maximum of the terrain, without crossfall
  double half_width = 4.5;      ///< m, crown to the foot of the curb
  double crossfall = 0.022;     ///< at the gutter; less towards the crown
  double face = 0.035;          ///< m, setback of the inclined curb face; its top is rounded
  double stone = 0.14;          ///< m, width of the curb stone
  double ramp = 1.20;           ///< m behind the foot, end of the ramp at a lowered curb
  double pavement = 2.30;       ///< m behind the foot, start of the gardens
  double pavement_fall = 0.02;  ///< towards the road
  double tufts = 0.03;          ///< m, maximum height of the lawns
};

/// One node of the ground's raster. All members are smooth enough for interpolation.
struct GroundVertex {
  float distance = 30.0F;  ///< m to the foot of the nearest curb, negative on the road
  float terrain = 0.0F;    ///< m, height of the gutter
  float curb = 0.12F;      ///< m, height of the nearest curb
  float pavement =
      0.12F;  ///< m, height of the pavement behind it above the gutter: more than `curb` where that is lowered
};

/// The ground as a height field: interpolated raster nodes plus the analytic street profile, so that curbs are sharp.
/// Frame: world. Immutable after building; safe from any thread.
class Ground {
 public:
  static constexpr double kPitch = 0.25;  ///< m between nodes

  Ground() = default;
  Ground(double x0, double y0, int width, int height, const StreetProfile& profile);

  [[nodiscard]] GroundVertex& node(int ix, int iy) { return nodes_[index(ix, iy)]; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] double x_of(int ix) const { return x0_ + ix * kPitch; }
  [[nodiscard]] double y_of(int iy) const { return y0_ + iy * kPitch; }
  [[nodiscard]] bool inside(double x, double y) const {
    return x >= x0_ && y >= y0_ && x < x_of(width_ - 1) && y < y_of(height_ - 1);
  }
  [[nodiscard]] const StreetProfile& profile() const { return profile_; }

  /// The interpolated raster; outside it, the value at the nearest border.
  [[nodiscard]] GroundVertex at(float x, float y) const;
  /// Height of the ground. `rough` adds the texture of lawns (not used for wheels and truth).
  [[nodiscard]] float height_at(float x, float y, bool rough = false) const {
    const GroundVertex node = at(x, y);
    return height_of(node) + (rough ? lawn(node, x, y) : 0.0F);
  }
  [[nodiscard]] float height_of(const GroundVertex& node) const;
  [[nodiscard]] Surface surface_of(const GroundVertex& node) const;

  /// First intersection of a ray of slope dz per horizontal metre with the ground: horizontal metres from its origin,
  /// negative if there is none within `reach`. (dx, dy) is a unit vector.
  [[nodiscard]] float cast(float x, float y, float z, float dx, float dy, float dz, float reach) const;

  /// Call it once all nodes are set: computes the height bounds that speed up cast().
  void finish();

 private:
  /// A strip along the street, by its distance to the curb, m, with a bound on the ground's slope in it.
  struct Zone {
    float from, to, slope;
  };
  [[nodiscard]] std::array<Zone, 5> zones() const;
  [[nodiscard]] std::size_t index(int ix, int iy) const {
    return static_cast<std::size_t>(iy) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(ix);
  }
  [[nodiscard]] float lawn(const GroundVertex& node, float x, float y) const;

  StreetProfile profile_;
  double x0_ = 0;
  double y0_ = 0;
  int width_ = 0;
  int height_ = 0;
  float highest_ = 0;
  std::vector<GroundVertex> nodes_;
};

}  // namespace curbstone::simulate::world
