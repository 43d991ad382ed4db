#pragma once

namespace curbstone::log_tool {

// Each parses its command line, runs, and returns the exit status: 0, 1 if the log is damaged, 2 for wrong usage. They
// throw std::runtime_error with a one-line message.

int run_info(int argc, char** argv);
int run_cut(int argc, char** argv);
int run_join(int argc, char** argv);
/// Returns 0 for a damaged log too, because it repairs damage.
int run_repair(int argc, char** argv);
int run_filter(int argc, char** argv);
int run_csv(int argc, char** argv);
int run_pcd(int argc, char** argv);

}  // namespace curbstone::log_tool
