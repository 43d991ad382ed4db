// A warp of 32 real threads that meet at sync() and nowhere else: what one lane reads before another has written it is
// a race that ThreadSanitizer sees (preset tsan), and a sync() that not all lanes reach never returns.
#include <gtest/gtest.h>

#include <barrier>
#include <cstring>
#include <thread>
#include <vector>

#include "services/tensor_voting/cuda/batch_pipeline.hpp"
#include "tests/services/tensor_voting/clouds.hpp"
#include "tests/services/tensor_voting/cuda/cuda_host_machine.hpp"

namespace curbstone::tensor_voting::cuda {
namespace {

struct ThreadedWarp {
  template <class T>
  struct Lanes {  // this thread's
    T value{};
    T& operator[](std::uint32_t) { return value; }
  };
  std::uint32_t lane;
  std::barrier<>& barrier;

  template <class F>
  void each(const F& f) const {
    f(lane);
  }
  void sync() const { barrier.arrive_and_wait(); }
};

struct ThreadedMachine : HostMachine {
  template <class F>
  void for_each_window(std::uint32_t n, const F& f) const {
    typename F::Memory memory{};
    std::barrier barrier(kWarp);
    std::vector<std::jthread> lanes;
    for (std::uint32_t lane = 0; lane < kWarp; ++lane) {
      lanes.emplace_back([&, lane] {
        ThreadedWarp warp{lane, barrier};
        for (std::uint32_t window = 0; window < n; ++window) {
          f(warp, memory, window);
          warp.sync();  // the next window has a memory of its own
        }
      });
    }
  }
};

template <class Machine>
std::vector<kernels::TensorF> vote(const std::vector<Eigen::Vector3d>& points, const BatchRequest& request) {
  const Machine machine;
  BatchPipeline<const Machine> pipeline(machine);
  pipeline.upload(points[0].data(), static_cast<std::uint32_t>(points.size()));
  pipeline.prepare(request);
  pipeline.vote();
  std::vector<kernels::TensorF> tensors;
  std::vector<VotedShape> shapes;
  pipeline.download(tensors, shapes);
  EXPECT_GT(pipeline.count_tests(), pipeline.count_pair_votes());
  return tensors;
}

TEST(CudaWarp, OfThreadsGivesTheBitsOfOneThread) {
  auto points = test_clouds::street(300, 1);
  for (Eigen::Vector3d& p : points) p *= 0.3;  // several tiles of voters for each window
  for (const bool all : {false, true}) {
    const BatchRequest request{
        {.sigma = 1, .radius = 3, .voxel = 0}, {}, /*second_pass=*/all, /*equalise_density=*/all};
    const auto expected = vote<HostMachine>(points, request);
    const auto threaded = vote<ThreadedMachine>(points, request);
    EXPECT_EQ(std::memcmp(threaded.data(), expected.data(), expected.size() * sizeof(kernels::TensorF)), 0);
  }
}

}  // namespace
}  // namespace curbstone::tensor_voting::cuda
