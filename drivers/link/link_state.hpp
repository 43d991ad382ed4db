#pragma once

namespace curbstone::link {

/// Whether the port, bus or interface to a device can be used.
enum class LinkState { kDown, kUp };

}  // namespace curbstone::link
