#pragma once

#include <string>

namespace curbstone::test {

/// Before "SECONDS PROGRAM": the program gets SIGTERM after so long, and its exit status is the command's. By default
/// `timeout` sends SIGCONT behind the SIGTERM. That takes away the SIGSTOP by which LeakSanitizer, at the end of a
/// sanitized program, holds the threads, and it waits for their stop for ever: hence --foreground.
inline const std::string kStoppedAfter = "timeout --foreground --preserve-status ";

}  // namespace curbstone::test
