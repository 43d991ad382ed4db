#include "common/packing/value_packer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace curbstone {
namespace {

struct Sample {
  float height = 0;
  std::int16_t count = 0;
  bool operator==(const Sample&) const = default;
};

TEST(ValuePacker, BringsBackWhatWasPutInTheSameOrder) {
  std::mt19937 random(1);
  std::vector<Sample> samples(1000);
  for (Sample& s : samples) s = {static_cast<float>(random()) * 1e-6F, static_cast<std::int16_t>(random())};
  ValuePacker packer;
  packer.put(42.5);
  packer.put(samples);
  packer.put(std::vector<std::uint8_t>{});
  packer.put(std::uint16_t{7});
  const PackedValues packed = packer.pack();

  ValueUnpacker unpacker(packed);
  EXPECT_EQ(unpacker.take<double>(), 42.5);
  std::vector<Sample> again;
  unpacker.take(again);
  EXPECT_EQ(again, samples);
  std::vector<std::uint8_t> none{1, 2};
  unpacker.take(none);
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(unpacker.take<std::uint16_t>(), 7);
}

TEST(ValuePacker, BringsBackEveryBitOfNumbersThatAreNone) {
  const std::vector<float> odd{std::nanf("3"), -0.0F, INFINITY};
  ValuePacker packer;
  packer.put(odd);
  const PackedValues packed = packer.pack();
  std::vector<float> again;
  ValueUnpacker(packed).take(again);
  ASSERT_EQ(again.size(), odd.size());
  EXPECT_EQ(std::memcmp(again.data(), odd.data(), sizeof(float) * odd.size()), 0);
}

TEST(ValuePacker, TakesLittleRoomForNumbersThatAreAlike) {
  std::vector<std::int32_t> heights;
  for (int i = 0; i < 10'000; ++i) heights.push_back(1'000'000 + i % 50);
  ValuePacker packer;
  packer.put(heights);
  EXPECT_LT(packer.pack().size(), heights.size());  // a fourth
}

TEST(ValuePacker, SaysWhenSomethingElseIsUnpacked) {
  ValuePacker packer;
  packer.put(std::uint32_t{1});
  PackedValues packed = packer.pack();
  EXPECT_THROW((void)ValueUnpacker(packed).take<std::uint64_t>(), std::runtime_error);
  std::vector<int> values;
  EXPECT_THROW(ValueUnpacker(packed).take(values), std::runtime_error);
  packed.resize(3);
  EXPECT_THROW(ValueUnpacker{packed}, std::runtime_error);
}

TEST(ValuePacker, StepsBringBackEveryBitOfAField) {
  struct Fields {
    std::int64_t when;
    std::int16_t what;
    std::uint8_t how;
  };
  using Limits = std::numeric_limits<std::int64_t>;
  const std::vector<Fields> samples{
      {Limits::max(), -32768, 255}, {Limits::min(), 32767, 0}, {0, -1, 128}, {Limits::max(), 0, 127}};
  ValuePacker packer;
  packer.put_steps(samples, &Fields::when);
  packer.put_steps(samples, &Fields::what);
  packer.put_steps(samples, &Fields::how);
  packer.put_steps(std::vector<Fields>(), &Fields::how);
  const PackedValues packed = packer.pack();
  ValueUnpacker unpacker(packed);
  std::vector<Fields> back, none(3);
  unpacker.take_steps(back, &Fields::when);
  unpacker.take_steps(back, &Fields::what);
  unpacker.take_steps(back, &Fields::how);
  unpacker.take_steps(none, &Fields::how);
  ASSERT_EQ(back.size(), samples.size());
  EXPECT_TRUE(none.empty());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(back[i].when, samples[i].when);
    EXPECT_EQ(back[i].what, samples[i].what);
    EXPECT_EQ(back[i].how, samples[i].how);
  }
}

TEST(ValuePacker, StepsOfNeighboursThatAreAlikeTakeLittle) {
  struct Fields {
    std::int64_t when;
  };
  std::vector<Fields> samples;
  for (int i = 0; i < 10'000; ++i) samples.push_back({1'700'000'000'000'000 + 50'000 * i});
  ValuePacker packer;
  packer.put_steps(samples, &Fields::when);
  EXPECT_LT(packer.pack().size(), 1000U);
}

}  // namespace
}  // namespace curbstone
