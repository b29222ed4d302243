#pragma once
// SCREE_CLONES before a hot function lets the compiler build it for AVX-512, AVX2 and the baseline and pick at run
// time. Results do not depend on the choice: there is no fast-math and no contraction, so only independent lanes are
// vectorised. Empty under sanitizers (g++ 12 crashes with TSan) and elsewhere than g++ on x86-64.

#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__SANITIZE_ADDRESS__)
#define SCREE_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define SCREE_CLONES
#endif
