#include "tools/bench/curbs/scene_drive.hpp"

#include "tools/simulate/motion/motion.hpp"
#include "tools/simulate/motion/speed_profile.hpp"
#include "tools/simulate/town_setup.hpp"

namespace curbstone {

namespace {

constexpr double kWay = 24.0;      // m
constexpr double kReach = 150.0F;  // m, of the LiDAR

/// Along the scene's road, wheels on the ground.
class SceneMotion final : public Motion {
 public:
  SceneMotion(const CurbScene& scene, const SpeedProfile& profile) : scene_(scene), profile_(profile) {}
  [[nodiscard]] Pose T_world_base(double t) const override { return scene_.T_world_base(profile_.distance(t)); }

 private:
  const CurbScene& scene_;
  SpeedProfile profile_;
};

class SceneSurroundings final : public Surroundings {
 public:
  SceneSurroundings(const CurbScene& scene, const LidarNoise& noise) : scene_(scene), noise_(noise) {}
  void prepare(const PacketView& /*view*/) override {}
  [[nodiscard]] Rs16Shot measure(const Shot& shot) override {
    const Ray ray{shot.origin_world.cast<float>(), shot.direction_world.cast<float>()};
    return noise_.report(scene_.scene().cast(ray, kReach, {}, shot.noise), shot.noise);
  }

 private:
  const CurbScene& scene_;
  LidarNoise noise_;
};

}  // namespace

SceneDrive drive_scene(const CurbScene& scene, std::uint64_t seed) {
  SimulateConfig config;
  config.lidar.range_sigma = scene.options().noise;
  double seconds = config.standstill;
  const SpeedProfile profile = speed_profile(config, 60);
  while (profile.distance(seconds) < kWay) seconds += 0.05;
  const SceneMotion motion(scene, profile);
  const Drive drive{.motion = motion,
                    .make_surroundings = [&] { return std::make_unique<SceneSurroundings>(scene, config.lidar); },
                    .config = config,
                    .seed = seed,
                    .seconds = seconds,
                    .start_utime = 1'700'000'000'000'000};
  SceneDrive result;
  result.made = drive_tiles(drive);
  const PosePairs pairs = pair_up(true_trajectory(drive), result.made.trajectory);
  if (pairs.truth.size() > 2) result.T_world_map = align(pairs);
  for (double s = 0; s <= kWay; s += 1)
    result.eyes.push_back((scene.T_world_base(s) * config.vehicle.T_base_lidar()).translation());
  return result;
}

}  // namespace curbstone
