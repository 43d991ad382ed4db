#pragma once

namespace curbstone::evaluate {

/// `curbstone evaluate --map MAP --truth DIR`: scores a map against the truth. argv[0] is the subcommand's name.
int run_evaluate(int argc, char** argv);

}  // namespace curbstone::evaluate
