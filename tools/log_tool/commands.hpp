#pragma once

namespace curbstone::log_tool {

// Each reads its command line, does its work and returns the exit status: 0, 1 if the log is damaged, 2 for wrong
// usage. They throw std::runtime_error with one clear line.

int run_info(int argc, char** argv);
int run_cut(int argc, char** argv);
int run_join(int argc, char** argv);
/// Damage is what it is for: it returns 0 then too.
int run_repair(int argc, char** argv);
int run_filter(int argc, char** argv);
int run_csv(int argc, char** argv);
int run_pcd(int argc, char** argv);

}  // namespace curbstone::log_tool
