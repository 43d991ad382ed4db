#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>

#include "common/log/log_reader.hpp"
#include "common/log/log_writer.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone {
namespace {

constexpr int kEvents = 40;

/// Messages of many lengths that tell which one they are; some hold the sync word.
std::vector<std::uint8_t> numbered_message(int i) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(20 + i * 7 % 60), static_cast<std::uint8_t>(i));
  if (i % 5 == 0) std::copy_n("\xED\xA1\xDA\x01", 4, bytes.begin() + 4);
  return bytes;
}

class DamagedLog : public ::testing::Test {
 protected:
  DamagedLog() {
    {
      LogWriter log(file_);
      for (int i = 0; i < kEvents; ++i) {
        begins_.push_back(log.bytes());
        const auto bytes = numbered_message(i);
        log.write(i % 2 == 0 ? "IMU" : "LIDAR_POINTS", bytes.data(), static_cast<int>(bytes.size()),
                  1'000'000 + i * 10'000);
      }
      begins_.push_back(log.bytes());
    }
    std::ifstream in(file_, std::ios::binary);
    whole_.assign(std::istreambuf_iterator<char>(in), {});
  }

  struct Read {
    std::vector<int> intact;  ///< the messages that are as they were written
    std::int64_t others = 0;
    LogLoss loss;
  };
  [[nodiscard]] Read read(const std::string& bytes) const {
    std::ofstream(file_, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    LogReader reader(file_);
    Read out;
    while (const auto event = reader.next()) {
      const int i = event->bytes.empty() ? 0 : event->bytes[0];
      if (i < kEvents && event->bytes == numbered_message(i)) {
        out.intact.push_back(i);
      } else {
        ++out.others;
      }
    }
    out.loss = reader.loss();
    return out;
  }
  [[nodiscard]] int record_at(std::size_t byte) const {
    const auto after = std::upper_bound(begins_.begin(), begins_.end(), static_cast<std::int64_t>(byte));
    return static_cast<int>(after - begins_.begin()) - 1;
  }

  test::TemporaryFolder folder_ = test::TemporaryFolder::in_memory();
  std::string file_ = folder_ / "damaged.lcmlog";
  std::vector<std::int64_t> begins_;
  std::string whole_;
};

TEST_F(DamagedLog, AnyByteThatIsWrongCostsOneMessageAtMost) {
  for (std::size_t at = 0; at < whole_.size(); ++at) {
    std::string bytes = whole_;
    bytes[at] = static_cast<char>(bytes[at] ^ (1 << at % 8));
    const Read got = read(bytes);
    std::vector<int> lost;
    for (int i = 0; i < kEvents; ++i) {
      if (std::find(got.intact.begin(), got.intact.end(), i) == got.intact.end()) lost.push_back(i);
    }
    ASSERT_LE(lost.size(), 1U) << "byte " << at;
    ASSERT_EQ(lost, lost.empty() ? lost : std::vector{record_at(at)}) << "byte " << at;
  }
}

TEST_F(DamagedLog, AHoleCostsWhatStandsInItAndIsCounted) {
  for (int first = 1; first + 3 < kEvents; first += 3) {
    std::string bytes = whole_;
    const auto begin = static_cast<std::size_t>(begins_[static_cast<std::size_t>(first)]);
    const auto end = static_cast<std::size_t>(begins_[static_cast<std::size_t>(first) + 3]);
    std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(begin), bytes.begin() + static_cast<std::ptrdiff_t>(end), 0);
    const Read got = read(bytes);
    EXPECT_EQ(got.intact.size(), kEvents - 3U);
    EXPECT_EQ(got.others, 0);
    EXPECT_EQ(got.loss.places, 1);
    EXPECT_EQ(got.loss.bytes, static_cast<std::int64_t>(end - begin));
    EXPECT_EQ(got.loss.missing, 3);
    EXPECT_NEAR(got.loss.seconds, 0.04, 1e-9);
  }
}

TEST_F(DamagedLog, NumbersThatAreDamagedCountNothingAsMissing) {
  const auto numbered = [](std::string bytes, std::int64_t record, std::uint64_t number) {
    for (std::size_t i = 0; i < 8; ++i)
      bytes[static_cast<std::size_t>(record) + 4 + i] = static_cast<char>(number >> (56 - 8 * i));
    return bytes;
  };
  constexpr std::uint64_t kLowest = std::uint64_t{1} << 63;
  std::string hole = whole_;
  std::fill(hole.begin() + begins_[11], hole.begin() + begins_[14], 0);
  for (const std::uint64_t before : {kLowest, kLowest - 2, std::uint64_t{0}, ~std::uint64_t{0}}) {
    for (const std::uint64_t behind : {kLowest, kLowest - 2, ~std::uint64_t{0}}) {
      const Read got = read(numbered(numbered(hole, begins_[10], before), begins_[14], behind));
      EXPECT_EQ(got.intact.size(), kEvents - 3U);
      EXPECT_EQ(got.loss.missing, before == kLowest - 2 && behind == kLowest ? 1 : 0) << before << " " << behind;
    }
  }
}

TEST_F(DamagedLog, BytesThatAreNotThereCostTheirMessagesAlone) {
  for (std::size_t from = 5; from + 40 < whole_.size(); from += 17) {
    std::string bytes = whole_;
    bytes.erase(from, 30);
    const Read got = read(bytes);
    const int touched = record_at(from + 29) - record_at(from) + 1;
    EXPECT_GE(static_cast<int>(got.intact.size()), kEvents - touched) << "byte " << from;
    EXPECT_TRUE(got.loss.damaged() || got.loss.cut_off > 0) << "byte " << from;
  }
}

TEST_F(DamagedLog, CutOffAnywhereItGivesTheWholeMessagesBefore) {
  for (std::size_t size = 4; size < whole_.size(); ++size) {
    const Read got = read(whole_.substr(0, size));
    const auto last = std::upper_bound(begins_.begin(), begins_.end(), static_cast<std::int64_t>(size)) - 1;
    EXPECT_EQ(static_cast<std::int64_t>(got.intact.size()), last - begins_.begin()) << size;
    EXPECT_EQ(got.loss.cut_off, *last == static_cast<std::int64_t>(size) ? 0 : static_cast<std::int64_t>(size) - *last)
        << size;
  }
}

TEST_F(DamagedLog, RandomDamageNeverEndsTheProgramNorLosesWhatIsFarFromIt) {
  std::mt19937 random(4);
  for (int round = 0; round < 300; ++round) {
    std::string bytes = whole_;
    std::vector<bool> touched(kEvents + 1);
    for (int flip = 0; flip < 6; ++flip) {
      const std::size_t at = random() % bytes.size();
      bytes[at] = static_cast<char>(random());
      const auto record = static_cast<std::size_t>(record_at(at));
      touched[record] = true;
      if (record > 0) touched[record - 1] = true;  // its neighbour is believed by what stands behind it
    }
    const Read got = read(bytes);
    for (int i = 0; i < kEvents; ++i) {
      if (touched[static_cast<std::size_t>(i)]) continue;
      EXPECT_NE(std::find(got.intact.begin(), got.intact.end(), i), got.intact.end()) << round << ": message " << i;
    }
  }
}

}  // namespace
}  // namespace curbstone
