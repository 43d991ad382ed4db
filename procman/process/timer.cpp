#include "procman/process/timer.hpp"

#include <sys/timerfd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace curbstone::procman::process {

Timer::Timer(EventLoop& loop, std::function<void()> task)
    : loop_(loop), fd_(timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC)) {
  if (!fd_) throw std::system_error(errno, std::generic_category(), "timerfd");
  loop_.watch(fd_.get(), [this, task = std::move(task)] {
    std::uint64_t expirations = 0;
    if (read(fd_.get(), &expirations, sizeof expirations) > 0) task();
  });
}

Timer::~Timer() {
  loop_.unwatch(fd_.get());
}

void Timer::arm(std::int64_t due) {
  const std::int64_t at = std::max<std::int64_t>(due, 1);  // 0 would disarm
  itimerspec setting{};
  setting.it_value.tv_sec = at / 1'000'000;
  setting.it_value.tv_nsec = (at % 1'000'000) * 1000;
  timerfd_settime(fd_.get(), TFD_TIMER_ABSTIME, &setting, nullptr);
}

}  // namespace curbstone::procman::process
