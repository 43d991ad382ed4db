#include "drivers/encoder/wheels_output.hpp"

#include <gmock/gmock.h>

#include "tests/drivers/recorder.hpp"

namespace curbstone::encoder {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class WheelsOutputTest : public ::testing::Test {
 protected:
  /// Samples each 10 ms for `seconds`, whose stamps lie `behind` us before their arrivals.
  void publish(int seconds, std::int64_t behind) {
    for (const std::int64_t end = now_ + seconds * 1'000'000; now_ < end; now_ += 10'000) {
      wheels_t message{};
      message.utime = now_ - behind;
      output_.publish(message, now_);
    }
  }
  NodeReport report() const {
    NodeReport report;
    output_.report(report);
    return report;
  }
  std::int64_t now_ = 1'700'000'000'000'000;  // us
  test::Recorder<wheels_t> recorder_{"WHEELS"};
  WheelsOutput output_{recorder_.bus()};
};

TEST_F(WheelsOutputTest, TellsStampMinusArrival) {
  publish(3, 400);
  EXPECT_EQ(report().counters["clock.difference_us"], -400);
  EXPECT_THAT(report().faults, IsEmpty());
}

TEST_F(WheelsOutputTest, StampsOfAClockThatWasSetAreAFaultUntilTheyFollow) {
  publish(3, 400);
  now_ += 80'000;  // the host's clock was set forward
  publish(3, 80'400);
  EXPECT_EQ(report().counters["clock.difference_us"], -80'400);
  EXPECT_THAT(report().faults, Contains(HasSubstr("stamps lie 80 ms before the arrivals")));
  publish(3, 400);
  EXPECT_THAT(report().faults, IsEmpty());
}

}  // namespace
}  // namespace curbstone::encoder
