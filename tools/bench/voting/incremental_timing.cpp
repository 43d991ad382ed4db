#include "tools/bench/voting/incremental_timing.hpp"

#include <time.h>

#include <Eigen/Core>
#include <algorithm>
#include <curbstone/map_points_t.hpp>
#include <curbstone/voted_points_t.hpp>
#include <utility>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/statistics/quantile.hpp"
#include "services/tensor_voting/cuda/cuda_voting.hpp"
#include "services/tensor_voting/voting/batch_voting.hpp"
#include "services/tensor_voting/voting/voting_field.hpp"
#include "services/tensor_voting/worker/point_tiles.hpp"
#include "services/tensor_voting/worker/tensor_voting_node.hpp"

namespace curbstone::bench::voting {

namespace {

constexpr std::int32_t kStepsPerMetre = 500;

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

tensor_voting::worker::TensorVotingConfig two_scales() {
  tensor_voting::worker::TensorVotingConfig config;
  config.sigma = {0.1, 0.3};
  config.voxel = {0.05, 0.1};
  return config;
}

/// Times only the fields, fed as by a worker.
class FieldTimer {
 public:
  FieldTimer() {
    const auto scales = two_scales().scales();
    for (const tensor_voting::voting::VotingParameters& scale : scales) fields_.emplace_back(scale);
    if (!tensor_voting::cuda::cuda_available()) return;
    std::vector<tensor_voting::cuda::CudaVotingField> on_gpu;
    for (const tensor_voting::voting::VotingParameters& scale : scales) on_gpu.emplace_back(scale);
    cuda_.emplace(std::move(on_gpu));
  }
  void add(const map_points_t& message) {
    const TileKey key{message.tile_x, message.tile_y};
    const tensor_voting::worker::PointTiles::Taken taken = map_.take(message);
    if (taken.outcome != tensor_voting::worker::PointTiles::Outcome::kAdded) return;
    const std::int32_t z_origin = map_.find(key)->z_origin * kStepsPerMetre;
    const std::span<const TilePoint> points = taken.removed ? std::span(map_.find(key)->points) : taken.added;
    const double begin = cpu_ms();
    for (tensor_voting::voting::VotingField& field : fields_) {
      if (taken.removed) field.remove(key);
      field.add(key, z_origin, points);
    }
    ms_ += cpu_ms() - begin;
    if (cuda_) cuda_->add(key, z_origin, taken.removed, points);
  }
  void end_revolution(bool counts) {
    if (cuda_) cuda_->end_revolution(counts);
  }
  double take_ms() { return std::exchange(ms_, 0.0); }
  [[nodiscard]] std::optional<CudaGrowth> cuda_growth() {
    if (!cuda_) return {};
    std::vector<TileKey> keys;
    for (const auto& [key, tile] : map_.tiles()) keys.push_back(key);
    return cuda_->growth(fields_, keys);
  }
  [[nodiscard]] const tensor_voting::worker::PointTiles& map() const { return map_; }
  [[nodiscard]] const std::vector<tensor_voting::voting::VotingField>& fields() const { return fields_; }

 private:
  tensor_voting::worker::PointTiles map_{{}};
  std::vector<tensor_voting::voting::VotingField> fields_;
  std::optional<CudaFields> cuda_;
  double ms_ = 0;
};

/// Times a complete worker on its own bus.
class WorkerTimer {
 public:
  WorkerTimer() : node_(two_scales(), "tensor_voting:1", bus_) {
    node_.connect(bus_);
    bus_.subscribe<voted_points_t>("VOTED_POINTS", [this](const voted_points_t& page) {
      if (page.page == 0) pacing_ms.push_back(static_cast<double>(now_ - page.utime) * 1e-3);
    });
  }
  void on_message(const std::string& channel, const void* data, int size) {
    const double begin = cpu_ms();
    bus_.inject(channel, data, size);
    bus_.dispatch();
    ms_ += cpu_ms() - begin;
  }
  void tick(std::int64_t now) {
    now_ = now;
    const double begin = cpu_ms();
    node_.tick(now);
    tick_ms_ += cpu_ms() - begin;
    bus_.dispatch();  // the messages it published
  }
  double take_ms() { return std::exchange(ms_, 0.0) + tick_ms(); }
  [[nodiscard]] double mean_tick_ms(int revolutions) const { return all_ticks_ms_ / std::max(1, revolutions); }

  std::vector<double> pacing_ms;  // one per published tile

 private:
  double tick_ms() {
    all_ticks_ms_ += tick_ms_;
    return std::exchange(tick_ms_, 0.0);
  }
  LocalBus bus_;
  tensor_voting::worker::TensorVotingNode node_;
  std::int64_t now_ = 0;
  double ms_ = 0;
  double tick_ms_ = 0;
  double all_ticks_ms_ = 0;
};

template <class Scalar>
Eigen::Matrix3d matrix(const tensor_voting::kernels::BasicTensor<Scalar>& t) {
  Eigen::Matrix<Scalar, 3, 3> m;
  m << t.xx, t.xy, t.xz, t.xy, t.yy, t.yz, t.xz, t.yz, t.zz;
  return m.template cast<double>();
}

/// The voters of a field and the votes they received.
struct VotersOfField {
  std::vector<tensor_voting::kernels::StepPoint> points;
  std::vector<tensor_voting::kernels::Tensor> tensors;
};
VotersOfField voters_of(const tensor_voting::voting::VotingField& field, const tensor_voting::worker::PointTiles& map) {
  VotersOfField voters;
  for (const auto& [key, tile] : map.tiles()) {
    const auto voter_of_point = field.voters_of_points(key);
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < voter_of_point.size(); ++i) {
      if (voter_of_point[i] != next) continue;
      ++next;
      const TilePoint& p = tile.points[i];
      voters.points.push_back(
          {key.x * kStepsPerTile + p.x, key.y * kStepsPerTile + p.y, tile.z_origin * kStepsPerMetre + p.z});
    }
    for (const tensor_voting::kernels::VoteSums& sums : field.sums(key))
      voters.tensors.push_back(tensor_voting::kernels::to_tensor(sums, field.parameters().ball));
  }
  return voters;
}

double max_difference(const VotersOfField& voters, tensor_voting::voting::VotingParameters parameters) {
  parameters.voxel = 0;           // the voters are thinned already
  parameters.radius *= 1 - 1e-6;  // the field excludes a pair exactly at the cut-off; rounding must not include it here
  std::vector<Eigen::Vector3d> cloud;
  for (const tensor_voting::kernels::StepPoint& p : voters.points)
    cloud.push_back(Eigen::Vector3d(p.x, p.y, p.z) * kPositionStep);
  const tensor_voting::voting::CloudVotes batch = tensor_voting::voting::vote_cloud(cloud, parameters);
  double most = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Matrix3d expected = matrix(batch.tensors[i]);
    const double difference = (matrix(voters.tensors[i]) - expected).norm();
    if (difference > 0) most = std::max(most, difference / expected.norm());
  }
  return most;
}

}  // namespace

IncrementalTiming time_incremental(const inputs::DriveSource& source) {
  FieldTimer fields;
  WorkerTimer worker;
  std::vector<double> voting_ms;
  std::vector<double> worker_ms;
  bool driving = false;
  const auto message = [&](const std::string& channel, const void* data, int size) {
    worker.on_message(channel, data, size);
    if (channel == "MAP_POINTS") {
      map_points_t points{};
      if (points.decode(data, 0, size) >= 0) fields.add(points);
    }
    if (channel != "MAP_POSE") return;
    const double ms[] = {fields.take_ms(), worker.take_ms()};
    driving = driving || fields.map().num_points() > 0;
    fields.end_revolution(driving);
    if (!driving) return;
    voting_ms.push_back(ms[0]);
    worker_ms.push_back(ms[1]);
  };
  inputs::drive_and_map(source, {message, [&](std::int64_t now) { worker.tick(now); }});

  IncrementalTiming timing;
  timing.revolutions = static_cast<int>(voting_ms.size());
  timing.points = fields.map().num_points();
  timing.decomposition_ms = worker.mean_tick_ms(timing.revolutions);
  timing.pacing_p50_ms = quantile_or(worker.pacing_ms, 0.5, 0);
  timing.pacing_p95_ms = quantile_or(worker.pacing_ms, 0.95, 0);
  timing.voting = scan_times(voting_ms);
  timing.worker = scan_times(worker_ms);
  timing.cuda = fields.cuda_growth();
  for (const tensor_voting::voting::VotingField& field : fields.fields()) {
    const VotersOfField voters = voters_of(field, fields.map());
    timing.voters += voters.points.size();
    timing.pairs += field.num_pairs();
    timing.max_relative_difference =
        std::max(timing.max_relative_difference, max_difference(voters, field.parameters()));
  }
  return timing;
}

}  // namespace curbstone::bench::voting
