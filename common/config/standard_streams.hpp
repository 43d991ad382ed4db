#pragma once

namespace curbstone {

/// For the start of every program. Opens the standard streams that its caller has closed. When the program ends and not
/// all that it printed could be written, as on a full disk, a line on stderr says so and the exit status is 1. A reader
/// that has gone, as `head` does, is no failure.
void guard_standard_streams();

}  // namespace curbstone
