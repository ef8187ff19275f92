// The compiled module: loops and convolutions for the widest vectors of this processor. Its submodule
// `narrow` has those for the next narrower vectors.

#include "thread_team.h"
#include "rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#define LOOPS "loops.h"
#include "each_processor.h"

PYBIND11_MODULE(loops, module) {
    module.def("use_threads", [](int most) { most_threads = std::max(most, 1); });
    module.def("threads_for", &threads_for);
    auto next = module.def_submodule("narrow");
    narrow::define_loops(next);
    define_narrow_convolve(next);
#if defined(__x86_64__)
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
        throw py::import_error("this processor has no AVX2 or no FMA");
    if (__builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) {
        wide::define_loops(module);
        define_wide_convolve(module);
        return;
    }
#endif
    narrow::define_loops(module);
    define_narrow_convolve(module);
}
