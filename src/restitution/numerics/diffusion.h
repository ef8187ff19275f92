// Diffusion on a graph of nodes, in double precision; see expressions.py.

inline void diffuse(Rows<const Index> neighbours, Rows<const double> weights, int steps,
                   Rows<double> sums) {
    expect_one_shape(neighbours, weights);
    if (sums.count != weights.count || sums.length != 2)
        throw std::invalid_argument("arrays of different shapes");
    for (Index i = 0; i < neighbours.count; ++i)
        for (Index k = 0; k < neighbours.length; ++k)
            if (neighbours[i][k] < 0 || neighbours[i][k] >= sums.count)
                throw std::out_of_range("a neighbour is not the index of a node");
    std::vector<std::array<double, 2>> next(sums.count);
    for (; steps > 0; --steps) {
        for (Index i = 0; i < sums.count; ++i) {
            const Index* node = neighbours[i];
            const double* weight = weights[i];
            next[i] = {};
            for (Index k = 0; k < weights.length; ++k) {
                next[i][0] += weight[k] * sums[node[k]][0];
                next[i][1] += weight[k] * sums[node[k]][1];
            }
        }
        for (Index i = 0; i < sums.count; ++i) std::copy(next[i].begin(), next[i].end(), sums[i]);
    }
}

inline void define_diffusion(py::module_& module) { module.def("diffuse", &diffuse); }
