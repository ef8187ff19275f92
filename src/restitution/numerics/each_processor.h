// Includes the file LOOPS once for each kind of processor, in a namespace of its own. LANE_BYTES is the
// size of a vector.

#if defined(__x86_64__)

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2,fma"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,fma")
#endif
namespace narrow {
#define LANE_BYTES 32
#include LOOPS
#undef LANE_BYTES
}  // namespace narrow
#if defined(__clang__)
#pragma clang attribute pop
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512bw,avx512vl"))), \
                             apply_to = function)
#else
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512bw,avx512vl,prefer-vector-width=512")
#endif
namespace wide {
#define LANE_BYTES 64
#include LOOPS
#undef LANE_BYTES
}  // namespace wide
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#else

namespace narrow {
#define LANE_BYTES 16
#include LOOPS
#undef LANE_BYTES
}  // namespace narrow

#endif
