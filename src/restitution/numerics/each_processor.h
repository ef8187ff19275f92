// The file LOOPS for each kind of processor, in a namespace, with vectors of LANE_BYTES.

#if defined(__x86_64__)

#pragma GCC push_options
#pragma GCC target("avx2")
namespace narrow {
#define LANE_BYTES 32
#include LOOPS
#undef LANE_BYTES
}  // namespace narrow
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512bw,avx512vl,prefer-vector-width=512")
namespace wide {
#define LANE_BYTES 64
#include LOOPS
#undef LANE_BYTES
}  // namespace wide
#pragma GCC pop_options

#else

namespace narrow {
#define LANE_BYTES 16
#include LOOPS
#undef LANE_BYTES
}  // namespace narrow

#endif
