#pragma once

namespace curbstone::serial {

/// Raw bytes, 8N1, no flow control, at any baud that the driver can (termios2, BOTHER), whatever the last program left
/// behind; what waits in the queues is thrown away. Returns 0 or an errno. The driver may take another baud without an
/// error: see granted_baud().
[[nodiscard]] int set_raw_line(int fd, int baud);

/// The baud that the driver says it runs at; 0 if it does not say.
[[nodiscard]] int granted_baud(int fd);

}  // namespace curbstone::serial
