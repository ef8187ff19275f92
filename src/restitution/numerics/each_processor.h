// Includes the file LOOPS once for each instruction set, each time in a separate namespace and with
// vectors of LANE_BYTES bytes. `plain` works on any processor. `avx2` and `avx512` are added if the
// compiler supports several instruction sets in one file (MANY_PROCESSORS).

namespace plain {
#define LANE_BYTES 16
#include LOOPS
#undef LANE_BYTES
}  // namespace plain

#ifdef MANY_PROCESSORS

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma")
#endif
namespace avx2 {
#define LANE_BYTES 32
#include LOOPS
#undef LANE_BYTES
}  // namespace avx2
#if defined(__clang__)
#pragma clang attribute pop
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512bw,avx512vl"))), \
                             apply_to = function)
#else
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512bw,avx512vl,prefer-vector-width=512")
#endif
namespace avx512 {
#define LANE_BYTES 64
#include LOOPS
#undef LANE_BYTES
}  // namespace avx512
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#endif
