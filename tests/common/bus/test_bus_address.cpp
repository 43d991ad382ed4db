#include "common/bus/bus_address.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace curbstone
