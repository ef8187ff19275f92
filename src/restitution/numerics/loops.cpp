// The compiled module. It selects the loops and convolutions for the processor on which it runs.

#include "thread_team.h"
#include "rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#define LOOPS "loops.h"
#include "each_processor.h"

struct Kernels {
    const char* instruction_set;
    bool are_supported;
    void (*define_loops)(py::module_&);
    void (*define_convolve)(py::module_&);
};

// Defines the kernels that the environment variable RESTITUTION_KERNELS names or, by default, the kernels
// with the widest vectors that the processor supports.
PYBIND11_MODULE(loops, module) {
    module.def("use_threads", [](int most) { most_threads = std::max(most, 1); });
    module.def("threads_for", &threads_for);
    const Kernels all[] = {
#ifdef MANY_PROCESSORS
        {"avx512",
         __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"),
         avx512::define_loops, define_avx512_convolve},
        {"avx2", __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"),
         avx2::define_loops, define_avx2_convolve},
#endif
        {"plain", true, plain::define_loops, define_plain_convolve},
    };
    const char* set = std::getenv("RESTITUTION_KERNELS");
    const std::string wanted = set ? set : "";
    for (const Kernels& kernels : all) {
        if (!kernels.are_supported || (!wanted.empty() && wanted != kernels.instruction_set)) continue;
        kernels.define_loops(module);
        kernels.define_convolve(module);
        module.attr("instruction_set") = kernels.instruction_set;
        return;
    }
    throw py::import_error("the processor or the compiled module does not support " + wanted);
}
