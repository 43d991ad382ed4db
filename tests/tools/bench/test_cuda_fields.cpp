#include "tools/bench/voting/cuda_fields.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "services/tensor_voting/cuda/field_pipeline.hpp"
#include "tests/services/tensor_voting/clouds.hpp"
#include "tests/services/tensor_voting/cuda/cuda_host_machine.hpp"

namespace curbstone::bench {
namespace {

using tensor_voting::voting::VotingField;

constexpr tensor_voting::voting::VotingParameters kScale{.sigma = 0.1, .radius = 0.3, .voxel = 0.05};

tensor_voting::cuda::CudaVotingField in_the_devices_place() {
  using namespace tensor_voting;
  return cuda::CudaVotingField(kScale, 1'000'000, [](const cuda::CellGrid& grid, const kernels::Decay& decay) {
    return std::make_unique<cuda::ResidentVotersOn<cuda::HostMachine>>(cuda::HostMachine{}, grid, decay);
  });
}

TEST(CudaFields, HaveTheBitsOfTheCpusWhateverARevolutionBrings) {
  const test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(3'000, 1));
  std::vector<VotingField> on_the_cpu;
  on_the_cpu.emplace_back(kScale);
  std::vector<tensor_voting::cuda::CudaVotingField> fields;
  fields.push_back(in_the_devices_place());
  voting::CudaFields beside(std::move(fields));

  std::vector<TileKey> keys;
  int revolution = 0;
  for (const auto& [key, points] : tiles) {
    keys.push_back(key);
    const std::span<const TilePoint> all(points);
    for (const auto& part : {all.first(all.size() / 2), all.subspan(all.size() / 2)}) {
      on_the_cpu[0].add(key, 0, part);
      beside.add(key, 0, false, part);
    }
    if (key.x % 2 == 0) {  // the mapper has taken points out, in the same revolution
      on_the_cpu[0].remove(key);
      on_the_cpu[0].add(key, 0, all.subspan(all.size() / 3));
      beside.add(key, 0, true, all.subspan(all.size() / 3));
    }
    if (++revolution % 3 == 0) beside.end_revolution(revolution > 3);
  }
  const voting::CudaGrowth growth = beside.growth(on_the_cpu, keys);
  EXPECT_GT(growth.compared, 500U);
  EXPECT_EQ(growth.different, 0U);
  EXPECT_GT(growth.add.mean_ms, 0);
  EXPECT_GE(growth.add.max_ms, growth.add.mean_ms);

  const TileKey last = keys.back();
  on_the_cpu[0].remove(last);
  EXPECT_GT(beside.growth(on_the_cpu, keys).different, 0U) << "what is missing is seen";
}

}  // namespace
}  // namespace curbstone::bench
