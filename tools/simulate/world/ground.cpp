#include "tools/simulate/world/ground.hpp"

#include "tools/simulate/numerics/random.hpp"

namespace curbstone::simulate::world {

namespace {

constexpr float kLawnPitch = 0.12F;    // m, size of the tufts
constexpr float kTuftSlope = 26.0F;    // maximum, per metre of tuft height
constexpr double kCrossfall = 0.03;    // maximum, in addition to the terrain's slope
constexpr float kLargestStep = 0.25F;  // m, maximum rise across curb, ramp and lawn, in addition to slopes
constexpr float kTouching = 5e-4F;     // m above the ground at which a ray counts as a hit

float smooth_step(float t) {
  t = std::clamp(t, 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

float tuft(int ix, int iy) {
  const auto key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(ix)) << 32) | static_cast<std::uint32_t>(iy);
  return static_cast<float>(numerics::mix_bits(key) >> 40) * (1.0F / 16777216.0F);
}

float mix(float a, float b, float f) {
  return a + (b - a) * f;
}

}  // namespace

Ground::Ground(double x0, double y0, int width, int height, const StreetProfile& profile)
    : profile_(profile),
      x0_(x0),
      y0_(y0),
      width_(width),
      height_(height),
      nodes_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

void Ground::finish() {
  highest_ = -1e9F;
  for (const auto& node : nodes_) highest_ = std::max(highest_, node.terrain + node.pavement);
  highest_ += 0.25F;
}

GroundVertex Ground::at(float x, float y) const {
  const float u = std::clamp((x - static_cast<float>(x0_)) * static_cast<float>(1.0 / kPitch), 0.0F,
                             static_cast<float>(width_) - 1.001F);
  const float v = std::clamp((y - static_cast<float>(y0_)) * static_cast<float>(1.0 / kPitch), 0.0F,
                             static_cast<float>(height_) - 1.001F);
  const int ix = static_cast<int>(u);
  const int iy = static_cast<int>(v);
  const float fx = u - static_cast<float>(ix);
  const float fy = v - static_cast<float>(iy);
  const GroundVertex* a = &nodes_[index(ix, iy)];
  const GroundVertex* b = a + width_;
  const float w00 = (1 - fx) * (1 - fy), w10 = fx * (1 - fy), w01 = (1 - fx) * fy, w11 = fx * fy;
  return {w00 * a[0].distance + w10 * a[1].distance + w01 * b[0].distance + w11 * b[1].distance,
          w00 * a[0].terrain + w10 * a[1].terrain + w01 * b[0].terrain + w11 * b[1].terrain,
          w00 * a[0].curb + w10 * a[1].curb + w01 * b[0].curb + w11 * b[1].curb,
          w00 * a[0].pavement + w10 * a[1].pavement + w01 * b[0].pavement + w11 * b[1].pavement};
}

float Ground::height_of(const GroundVertex& node) const {
  const float d = node.distance;
  if (d <= 0) {  // carriageway: a parabola with its vertex slightly beyond the centre
    const float reach = 1.25F * static_cast<float>(profile_.half_width);
    const float in = std::min(-d, reach);
    return node.terrain + static_cast<float>(profile_.crossfall) * in * (1.0F - in / (2.0F * reach));
  }
  const auto face = static_cast<float>(profile_.face);
  if (d < face) {  // curb face: steep at its foot, rounded at its top
    const float left = 1.0F - d / face;
    return node.terrain + node.curb * (1.0F - left * left * left);
  }
  const auto stone = static_cast<float>(profile_.stone);
  const float ramp = smooth_step((d - stone) / (static_cast<float>(profile_.ramp) - stone));
  const float fall =
      static_cast<float>(profile_.pavement_fall) * (std::min(d, static_cast<float>(profile_.pavement)) - face);
  return node.terrain + mix(node.curb, node.pavement, ramp) + fall;
}

float Ground::lawn(const GroundVertex& node, float x, float y) const {
  const float beyond = node.distance - static_cast<float>(profile_.pavement);
  if (beyond <= 0) return 0.0F;
  const float u = x / kLawnPitch, v = y / kLawnPitch;
  const float bu = std::floor(u), bv = std::floor(v);
  const int iu = static_cast<int>(bu), iv = static_cast<int>(bv);
  const float fu = smooth_step(u - bu), fv = smooth_step(v - bv);
  const float value = mix(mix(tuft(iu, iv), tuft(iu + 1, iv), fu), mix(tuft(iu, iv + 1), tuft(iu + 1, iv + 1), fu), fv);
  return static_cast<float>(profile_.tufts) * value * std::min(1.0F, beyond / 0.15F);
}

Surface Ground::surface_of(const GroundVertex& node) const {
  if (node.distance <= 0) return Surface::kAsphalt;
  if (node.distance < static_cast<float>(profile_.stone)) return Surface::kCurbStone;
  if (node.distance < static_cast<float>(profile_.pavement)) return Surface::kPavement;
  // Where the curb is lowered a driveway continues through the garden.
  return node.pavement - node.curb > 0.03F ? Surface::kPavement : Surface::kGrass;
}

std::array<Ground::Zone, 5> Ground::zones() const {
  const auto face = static_cast<float>(profile_.face), ramp = static_cast<float>(profile_.ramp);
  const auto pavement = static_cast<float>(profile_.pavement);
  const auto slope = static_cast<float>(profile_.steepness + kCrossfall);
  return {{{-1e9F, 0.0F, slope + 0.02F},
           {0.0F, face, 14.0F},
           {face, ramp, slope + 0.19F},
           {ramp, pavement, slope},
           {pavement, 1e9F, std::max(0.8F, kTuftSlope * static_cast<float>(profile_.tufts))}}};
}

float Ground::cast(float x, float y, float z, float dx, float dy, float dz, float reach) const {
  // The distance to the next zone bounds the step, because the distance to a curb changes by at most one metre per
  // metre.
  const std::array<Zone, 5> zones = this->zones();
  const auto tufts = static_cast<float>(profile_.tufts);
  const auto slope = static_cast<float>(profile_.steepness + kCrossfall);
  const float x_end = static_cast<float>(x_of(width_ - 1)), y_end = static_cast<float>(y_of(height_ - 1));
  const float descent = -dz;

  float u = 0.0F;
  if (z > highest_) {  // no hit before the ray is as low as the highest ground
    if (descent <= 0) return -1.0F;
    u = (z - highest_) / descent;
  }
  float last_gap = 1.0F, last_step = 0.0F;
  for (int guard = 0; guard < 400 && u < reach; ++guard) {
    const float px = x + u * dx, py = y + u * dy;
    if (px < static_cast<float>(x0_) || py < static_cast<float>(y0_) || px >= x_end || py >= y_end) return -1.0F;
    const GroundVertex node = at(px, py);
    const float smooth_gap = z + u * dz - height_of(node);
    // This far above the ground neither a curb nor a lawn can be hit.
    const float over_all = (smooth_gap - kLargestStep) / std::max(1e-3F, descent + slope);
    std::size_t k = 0;
    while (node.distance > zones[k].to) ++k;
    const Zone& zone = zones[k];
    const float to_next = std::min(node.distance - zone.from, zone.to - node.distance) + 2e-3F;
    const bool on_lawn = k == zones.size() - 1;
    float within = 0.0F;
    if (on_lawn && smooth_gap > 1.5F * tufts) {
      within = (smooth_gap - tufts) / std::max(1e-3F, descent + slope);
    } else {
      const float gap = smooth_gap - (on_lawn ? lawn(node, px, py) : 0.0F);
      if (gap < 0) return u - last_step * gap / (gap - last_gap);  // interpolates between the last two steps
      if (gap < kTouching) return u + gap / std::max(descent + 0.02F, 0.05F);
      last_gap = gap;
      within = gap / std::max(1e-3F, descent + zone.slope);
    }
    last_step = std::max({std::min(within, to_next), over_all, 1e-3F});
    u += last_step;
  }
  return -1.0F;
}

}  // namespace curbstone::simulate::world
