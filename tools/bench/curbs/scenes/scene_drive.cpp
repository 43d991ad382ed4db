#include "tools/bench/curbs/scenes/scene_drive.hpp"

#include "tools/simulate/motion/motion.hpp"
#include "tools/simulate/motion/speed_profile.hpp"
#include "tools/simulate/town_setup.hpp"

namespace curbstone::bench::curbs::scenes {

namespace {

constexpr double kWay = 24.0;      // m
constexpr double kReach = 150.0F;  // m, of the LiDAR

/// A motion along the scene's road, with the wheels on the ground.
class SceneMotion final : public simulate::motion::Motion {
 public:
  SceneMotion(const CurbScene& scene, const simulate::motion::SpeedProfile& profile)
      : scene_(scene), profile_(profile) {}
  [[nodiscard]] Pose T_world_base(double t) const override { return scene_.T_world_base(profile_.distance(t)); }

 private:
  const CurbScene& scene_;
  simulate::motion::SpeedProfile profile_;
};

class SceneSurroundings final : public simulate::sensors::Surroundings {
 public:
  SceneSurroundings(const CurbScene& scene, const simulate::sensors::LidarNoise& noise)
      : scene_(scene), noise_(noise) {}
  void prepare(const simulate::sensors::PacketView& /*view*/) override {}
  [[nodiscard]] simulate::devices::LidarShot measure(const simulate::sensors::Shot& shot) override {
    const simulate::world::Ray ray{shot.origin_world.cast<float>(), shot.direction_world.cast<float>()};
    return noise_.report(scene_.scene().cast(ray, kReach, {}, shot.noise), shot.noise);
  }

 private:
  const CurbScene& scene_;
  simulate::sensors::LidarNoise noise_;
};

}  // namespace

SceneDrive drive_scene(const CurbScene& scene, std::uint64_t seed) {
  simulate::rig::SimulateConfig config;
  config.lidar.range_sigma = scene.options().noise;
  double seconds = config.standstill;
  const simulate::motion::SpeedProfile profile = simulate::speed_profile(config, 60);
  while (profile.distance(seconds) < kWay) seconds += 0.05;
  const SceneMotion motion(scene, profile);
  const simulate::rig::Drive drive{
      .motion = motion,
      .make_surroundings = [&] { return std::make_unique<SceneSurroundings>(scene, config.lidar); },
      .config = config,
      .seed = seed,
      .seconds = seconds,
      .start_utime = 1'700'000'000'000'000};
  SceneDrive result;
  result.made = drive_tiles(drive);
  const evaluate::truth::PosePairs pairs = evaluate::truth::pair_up(true_trajectory(drive), result.made.trajectory);
  if (pairs.truth.size() > 2) result.T_world_map = evaluate::truth::align(pairs);
  for (double s = 0; s <= kWay; s += 1)
    result.eyes.push_back((scene.T_world_base(s) * config.vehicle.T_base_lidar()).translation());
  return result;
}

}  // namespace curbstone::bench::curbs::scenes
