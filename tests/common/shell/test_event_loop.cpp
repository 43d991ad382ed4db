#include "common/shell/event_loop.hpp"

#include <gtest/gtest.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <chrono>

namespace curbstone {
namespace {

using namespace std::chrono_literals;

TEST(EventLoop, DoesWhatMayWaitUntilThereIsNoMoreOfIt) {
  EventLoop loop;
  int pieces = 0;
  loop.when_idle([&] { return ++pieces < 5; });
  loop.every(20ms, [&] { loop.stop(); });
  loop.run();
  EXPECT_EQ(pieces, 5);
}

TEST(EventLoop, TellsReadableAndWritableOfOneDescriptorApart) {
  EventLoop loop;
  const int fd = eventfd(0, EFD_NONBLOCK);  // writable, and not readable until it was written to
  std::string order;
  loop.watch(fd, [&] {
    order += 'r';
    loop.unwatch(fd);
    loop.stop();
  });
  loop.watch_writable(fd, [&] {
    order += 'w';
    if (order.size() < 3) return;
    loop.unwatch_writable(fd);
    const std::uint64_t one = 1;
    (void)!write(fd, &one, sizeof one);
  });
  loop.run();
  EXPECT_EQ(order, "wwwr");
  close(fd);
}

TEST(EventLoop, WhatHasComeGoesBeforeWhatMayWait) {
  EventLoop loop;
  const int fd = eventfd(1, EFD_NONBLOCK);
  std::string order;
  loop.watch(fd, [&] {
    std::uint64_t taken = 0;
    (void)!read(fd, &taken, sizeof taken);
    order += 'm';
    if (order.size() > 6) loop.stop();
  });
  loop.when_idle([&] {
    order += 'i';
    const std::uint64_t one = 1;
    (void)!write(fd, &one, sizeof one);  // a message comes during each piece
    return true;
  });
  loop.run();
  EXPECT_EQ(order, "mimimim");
  close(fd);
}

TEST(EventLoop, AsksAgainForWhatMayWaitAfterATimer) {
  EventLoop loop;
  int timers = 0;
  int asked = 0;
  loop.when_idle([&] {
    ++asked;
    return false;
  });
  loop.every(50ms, [&] {  // a timer that is late by its period goes before an idle task
    if (++timers == 3) loop.stop();
  });
  loop.run();
  EXPECT_GE(asked, 3) << "at the start and after each timer";
  EXPECT_LE(asked, 4) << "and not all the time";
}

/// Events that follow each other are handled together, and neither timers nor idle work wait for them.
TEST(EventLoop, GathersWhatComesAtAHighRate) {
  EventLoop loop;
  const int fd = eventfd(1, EFD_NONBLOCK);
  std::uint64_t events = 0;
  int times = 0;
  loop.watch(fd, [&] {
    std::uint64_t taken = 0;
    (void)!read(fd, &taken, sizeof taken);
    events += taken;
    ++times;
  });
  int ticks = 0;
  loop.every(1ms, [&] {
    const std::uint64_t one = 1;
    (void)!write(fd, &one, sizeof one);
    if (++ticks == 100) loop.stop();
  });
  loop.gather(50ms);
  loop.run();
  EXPECT_EQ(ticks, 100) << "timers are on time";
  EXPECT_LE(times, 4);
  EXPECT_GE(events, 40U);
  close(fd);
}

/// A node that has nothing to do while idle costs no look.
TEST(EventLoop, GathersThoughSomethingMightHaveWaited) {
  EventLoop loop;
  const int fd = eventfd(1, EFD_NONBLOCK);
  int times = 0;
  int asked = 0;
  loop.watch(fd, [&] { ++times; });  // it stays readable
  loop.when_idle([&] {
    ++asked;
    return false;
  });
  loop.every(200ms, [&] { loop.stop(); });
  loop.gather(20ms);
  loop.run();
  EXPECT_LE(times, 11);
  EXPECT_GE(times, 3);
  EXPECT_GE(asked, times);
  close(fd);
}

/// Work of more pieces goes on while nothing comes, and what comes goes before it.
TEST(EventLoop, WhatMayWaitGoesOnWhileItGathers) {
  EventLoop loop;
  const int fd = eventfd(1, EFD_NONBLOCK);
  int times = 0;
  int pieces = 0;
  loop.watch(fd, [&] {
    std::uint64_t taken = 0;
    (void)!read(fd, &taken, sizeof taken);
    ++times;
  });
  loop.when_idle([&] {
    if (++pieces % 10 != 0) return true;
    const std::uint64_t one = 1;
    (void)!write(fd, &one, sizeof one);
    return false;
  });
  loop.every(100ms, [&] { loop.stop(); });
  loop.gather(10ms);
  loop.run();
  EXPECT_GE(times, 4);
  EXPECT_LE(times, 11);
  EXPECT_GE(pieces, 10 * times - 10);
  close(fd);
}

}  // namespace
}  // namespace curbstone
