#include "common/bus/socket/bus_address.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "common/bus/lcm_bus.hpp"

namespace curbstone {
namespace {

TEST(BusAddress, IsReadAsLcmReadsIt) {
  const auto address = parse_bus_url("udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304");
  ASSERT_TRUE(address);
  EXPECT_EQ(address->group, "239.255.76.67");
  EXPECT_EQ(address->port, 7667);
  EXPECT_EQ(address->ttl, 0);
  EXPECT_EQ(address->buffer, 4194304);
  EXPECT_EQ(parse_bus_url("udpm://239.1.2.3:9000")->port, 9000);
  EXPECT_EQ(parse_bus_url("udpm://")->port, 7667);
  for (const char* const url :
       {"", "memq://", "udpm://239.255.76.67", "udpm://10.0.0.1:7667", "udpm://239.1.2.3:70000",
        "udpm://239.1.2.3:7667?ttl=300", "udpm://239.1.2.3:7667?ttl", "udpm://239.1.2.3:7667?tll=1"})
    EXPECT_FALSE(parse_bus_url(url)) << url;
}

TEST(LcmBus, RefusesWhatIsNoUrlOfABusInWords) {
  for (const char* url : {"tcpq://127.0.0.1:1", "nonsense://x", "mpudpm://239.255.76.67:7667", "udpm://10.0.0.1:7667",
                          "udpm:239.255.76.67", "file:///nowhere/a.lcmlog", "x"}) {
    try {
      LcmBus bus(url);
      ADD_FAILURE() << url;
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()).find(std::string("cannot open the bus ") + url), 0u) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace curbstone
