#pragma once

// A function with this attribute is compiled once for each width of vectors that x86 machines have, and the machine
// decides which one runs. All give the same bits, for no multiplication is fused with an addition. Sanitizers are not
// ready yet when a program makes that choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define CURBSTONE_FOR_EACH_VECTOR_WIDTH __attribute__((target_clones("avx2", "default")))
#else
#define CURBSTONE_FOR_EACH_VECTOR_WIDTH
#endif
