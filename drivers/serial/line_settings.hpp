#pragma once

namespace curbstone::serial {

/// Sets raw bytes, 8N1, no flow control, at any baud that the driver supports (termios2, BOTHER), independent of
/// earlier settings; discards the queues. Returns 0 or an errno. The driver may use another baud without an error: see
/// granted_baud().
[[nodiscard]] int set_raw_line(int fd, int baud);

/// The baud reported by the driver; 0 if it reports none.
[[nodiscard]] int granted_baud(int fd);

}  // namespace curbstone::serial
