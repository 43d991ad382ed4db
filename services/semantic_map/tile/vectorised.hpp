#pragma once

/// Before a function whose loops over doubles are to be built for each of the instruction sets that there may be: the
/// same operations (nothing is contracted or reordered), hence the same bits. Not with sanitizers, whose runtime is not
/// up yet when the choice is made.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CURBSTONE_VECTORISED __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define CURBSTONE_VECTORISED
#endif
