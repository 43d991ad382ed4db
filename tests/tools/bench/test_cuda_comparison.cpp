#include "tools/bench/voting/cuda_comparison.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace curbstone::bench {
namespace {

TEST(CudaComparison, WithoutADeviceIsNullAndSaysWhy) {
  if (tensor_voting::cuda::cuda_available()) GTEST_SKIP() << "there is a GPU";
  EXPECT_TRUE(voting::measure_cuda(std::vector<voting::BatchRow>(1), 1).empty());
  EXPECT_TRUE(voting::cuda_json({}).is_null());
  testing::internal::CaptureStdout();
  voting::print_cuda({});
  EXPECT_NE(testing::internal::GetCapturedStdout().find(tensor_voting::cuda::why_no_cuda()), std::string::npos);
}

TEST(CudaComparison, SetsTheCallBesideTheCpu) {
  voting::CudaRow row;
  row.cpu.points = 1000;
  row.cpu.ours.wall_ms = 50;
  row.gpu.device = "a device";
  row.gpu.call_ms = 2;
  const nlohmann::json json = voting::cuda_json(std::vector<voting::CudaRow>{row});
  ASSERT_EQ(json.size(), 1U);
  EXPECT_EQ(json[0]["device"], "a device");
  EXPECT_EQ(json[0]["ratio"], 25);
  testing::internal::CaptureStdout();
  voting::print_cuda(std::vector<voting::CudaRow>{row});
  EXPECT_NE(testing::internal::GetCapturedStdout().find("25.0x"), std::string::npos);
}

}  // namespace
}  // namespace curbstone::bench
