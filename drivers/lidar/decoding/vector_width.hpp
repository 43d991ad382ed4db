#pragma once

// A function with this attribute is compiled once for each vector width of x86 machines, and the version is chosen at
// run time. All versions give the same bits, because no multiplication is fused with an addition. Not with sanitizers:
// they are not initialised yet when the choice is made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(CURBSTONE_SANITIZED)
#define CURBSTONE_FOR_EACH_VECTOR_WIDTH __attribute__((target_clones("avx2", "default")))
#else
#define CURBSTONE_FOR_EACH_VECTOR_WIDTH
#endif
