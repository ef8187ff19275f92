// A step on few nodes; few_nodes.py documents it and has the equivalent array expressions.

template <class P, class T>
double step_on_few(Rows<T> d, Rows<const std::int64_t> nodes, Rows<const double> kernel,
                   Rows<const P> p, Rows<const P> g, const Bounds<P>& bounds,
                   const std::pair<double, int>& until) {
    const Rows<const P> lower = bounds.first, upper = bounds.second;
    expect_one_shape(p, g, lower, upper, d);
    const Index count = nodes.length;
    if (nodes.count != 2) throw std::invalid_argument("nodes must have two rows");
    const std::int64_t *is = nodes[0], *js = nodes[1];
    const auto [first_i, last_i] = std::minmax_element(is, is + count);
    const auto [first_j, last_j] = std::minmax_element(js, js + count);
    if (count && (*first_i < 0 || *last_i >= p.count || *last_i - *first_i >= kernel.length ||
                  *first_j < 0 || *last_j >= p.length || *last_j - *first_j >= kernel.count))
        throw std::invalid_argument("nodes outside the array or the kernel");
    std::vector<double> K(count * count), step(count), slope(count), least(count), most(count);
    double steepest = 0;
    for (Index k = 0; k < count; ++k) {
        const Index i = is[k], j = js[k];
        slope[k] = g[i][j];
        steepest = std::max(steepest, std::abs(slope[k]));
        least[k] = lower[i][j] - p[i][j];
        most[k] = upper[i][j] - p[i][j];
        for (Index l = 0; l < count; ++l)
            K[k * count + l] = kernel[std::abs(j - js[l])][std::abs(i - is[l])];
    }
    const double self = count ? kernel[0][0] : 0, enough = until.first * steepest;
    double largest = steepest;
    for (int sweep = 0; sweep < until.second && largest > enough; ++sweep) {
        largest = 0;
        for (Index k = 0; k < count; ++k) {
            const double wanted = step[k] - slope[k] / self;
            const double next = std::min(std::max(wanted, least[k]), most[k]), change = next - step[k];
            if (change == 0) continue;
            step[k] = next;
            largest = std::max(largest, std::abs(change) * self);
            const double* row = K.data() + k * count;
            double* slopes = slope.data();
#pragma omp simd
            for (Index l = 0; l < count; ++l) slopes[l] += row[l] * change;
        }
    }
    for (Index i = 0; i < d.count; ++i) std::fill(d[i], d[i] + d.length, T(0));
    double descent = 0;
    for (Index k = 0; k < count; ++k) {
        d[is[k]][js[k]] = T(step[k]);
        descent += double(g[is[k]][js[k]]) * d[is[k]][js[k]];
    }
    return descent;
}

template <class T>
void define_few_nodes(py::module_& module) {
    module.def("step_on_few", &step_on_few<double, T>);
    if (std::is_same_v<T, float>) module.def("step_on_few", &step_on_few<float, float>);
}
