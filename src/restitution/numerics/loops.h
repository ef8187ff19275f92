// All loops of the compiled module. loops.cpp includes this file once for each instruction set.
//
// Arrays have shape (nx, ny), double or single precision and contiguous rows.

#include "reductions.h"

#include "diffusion.h"
#include "multipoles.h"
#include "newton.h"
#include "node_tables.h"
#include "relief.h"
#include "contours.h"
#include "growing_bound.h"
#include "quadratic/fused_ops.h"
#include "quadratic/few_nodes.h"
#include "quadratic/grid_transfer.h"
#include "quadratic/local_mean.h"
#include "quadratic/near_filter.h"

template <class T>
void define_for(py::module_& module) {
    define_reductions<T>(module);
    define_newton<T>(module);
    define_fused_ops<T>(module);
    define_few_nodes<T>(module);
    define_local_mean<T>(module);
    define_near_filter<T>(module);
    define_grid_transfer<T>(module);
}

inline void define_loops(py::module_& module) {
    define_for<float>(module);
    define_for<double>(module);
    define_multipoles(module);
    define_lennard_jones(module);
    define_node_tables(module);
    define_diffusion(module);
    define_relief(module);
    define_contours(module);
    define_growing_bound(module);
}
