#pragma once

namespace curbstone::bench::viewer {

/// curbstone bench viewer: what a page of curbstone-viewer costs the network, and how soon and how often it draws.
int run_bench_viewer(int argc, char** argv);

}  // namespace curbstone::bench::viewer
