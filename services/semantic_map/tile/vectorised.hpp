#pragma once

/// Put it before a function to compile its loops over doubles for each instruction set; the loader selects one. The
/// operations are the same (nothing is contracted or reordered), hence the bits. Not with sanitizers, whose runtime is
/// not initialised yet when the loader selects.
#if defined(__x86_64__) && !defined(CURBSTONE_SANITIZED)
#define CURBSTONE_VECTORISED __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define CURBSTONE_VECTORISED
#endif
