#include "tools/bench/voting/cuda_comparison.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace curbstone {
namespace {

TEST(CudaComparison, WithoutADeviceIsNullAndSaysWhy) {
  if (cuda_available()) GTEST_SKIP() << "there is a GPU";
  EXPECT_TRUE(measure_cuda(std::vector<BatchRow>(1), 1).empty());
  EXPECT_TRUE(cuda_json({}).is_null());
  testing::internal::CaptureStdout();
  print_cuda({});
  EXPECT_NE(testing::internal::GetCapturedStdout().find(why_no_cuda()), std::string::npos);
}

TEST(CudaComparison, SetsTheCallBesideTheCpu) {
  CudaRow row;
  row.cpu.points = 1000;
  row.cpu.ours.wall_ms = 50;
  row.gpu.device = "a device";
  row.gpu.call_ms = 2;
  const nlohmann::json json = cuda_json(std::vector<CudaRow>{row});
  ASSERT_EQ(json.size(), 1U);
  EXPECT_EQ(json[0]["device"], "a device");
  EXPECT_EQ(json[0]["ratio"], 25);
  testing::internal::CaptureStdout();
  print_cuda(std::vector<CudaRow>{row});
  EXPECT_NE(testing::internal::GetCapturedStdout().find("25.0x"), std::string::npos);
}

}  // namespace
}  // namespace curbstone
