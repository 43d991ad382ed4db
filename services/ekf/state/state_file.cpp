#include "services/ekf/state/state_file.hpp"

#include <zlib.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "services/ekf/filter/covariance_inflation.hpp"

namespace curbstone::ekf::state {

namespace {

constexpr std::uint64_t kMagic = 0x32464b4542525543;  // "CURBEKF2"
constexpr std::size_t kMean = 3 + 3 + 4 + 3 + 3 + 3 + 1 + 2;
constexpr std::size_t kCovariance = static_cast<std::size_t>(model::kErrorSize) * model::kErrorSize;

struct File {
  std::uint64_t magic = kMagic;
  std::int64_t utime = 0;
  std::array<double, kMean> mean{};
  std::array<double, kCovariance> covariance{};
  double imu_turn = 0.0;
  std::uint64_t checksum = 0;  // of all members before it
};
static_assert(std::is_trivially_copyable_v<File>);

std::uint64_t checksum_of(const File& file) {
  return crc32(0, reinterpret_cast<const Bytef*>(&file), static_cast<uInt>(offsetof(File, checksum)));
}

}  // namespace

bool save_state(const std::string& path, const model::Belief& belief) {
  File file;
  file.utime = belief.utime;
  const model::NavState& x = belief.mean;
  Eigen::Map<Eigen::Matrix<double, static_cast<int>(kMean), 1>> mean(file.mean.data());
  mean << x.position, x.velocity, x.attitude.coeffs(), x.gyro_bias, x.accelerometer_bias, x.wheel_scale, x.axle,
      x.course;
  Eigen::Map<model::ErrorMatrix>(file.covariance.data()) = belief.covariance;
  file.imu_turn = belief.imu_turn;
  file.checksum = checksum_of(file);
  const std::string unfinished = path + ".unfinished";
  {
    std::ofstream out(unfinished, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(&file), sizeof file);
    if (!out.flush()) return false;
  }
  return std::rename(unfinished.c_str(), path.c_str()) == 0;
}

std::optional<model::Belief> load_state(const std::string& path) {
  File file;
  std::ifstream in(path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(&file), sizeof file) || in.get() != std::ifstream::traits_type::eof())
    return std::nullopt;
  if (file.magic != kMagic || file.checksum != checksum_of(file)) return std::nullopt;
  model::Belief belief;
  belief.utime = file.utime;
  model::NavState& x = belief.mean;
  const Eigen::Map<const Eigen::Matrix<double, static_cast<int>(kMean), 1>> mean(file.mean.data());
  x.position = mean.segment<3>(0);
  x.velocity = mean.segment<3>(3);
  x.attitude.coeffs() = mean.segment<4>(6);
  x.gyro_bias = mean.segment<3>(10);
  x.accelerometer_bias = mean.segment<3>(13);
  x.wheel_scale = mean.segment<3>(16);
  x.axle = mean[19];
  x.course = mean.segment<2>(20);
  belief.covariance = Eigen::Map<const model::ErrorMatrix>(file.covariance.data());
  belief.imu_turn = file.imu_turn;
  if (!filter::is_finite(belief) || !std::isfinite(belief.imu_turn)) return std::nullopt;
  x.attitude.normalize();
  return belief;
}

}  // namespace curbstone::ekf::state
