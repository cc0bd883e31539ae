// Functions that are compiled for several instruction sets, the widest that the processor has being chosen when the program starts.
//
// Only for loops of plain arithmetic: without contraction (-ffp-contract=off) the lanes of wide vectors give the bits of narrow
// ones, so pixels do not depend on the processor.
#pragma once

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define FLUXFARM_VECTOR_CLONES [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]]
#else
#define FLUXFARM_VECTOR_CLONES
#endif
