#pragma once

namespace curbstone::bench::viewer {

/// curbstone bench viewer: the network traffic of a page of curbstone-viewer, and how soon and how often it draws.
int run_bench_viewer(int argc, char** argv);

}  // namespace curbstone::bench::viewer
