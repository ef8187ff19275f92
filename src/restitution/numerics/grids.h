// Loops over the nodes of a grid that are no part of an iteration, in double precision: to coarser and
// finer grids, over the lags of influence coefficients, and over the neighbours of nodes. loops.h
// includes this.

template <class Coarse, class Fine>
void expect_halves(const Coarse& coarse, const Fine& fine) {
    if (coarse.count != (fine.count + 1) / 2 || coarse.length != (fine.length + 1) / 2)
        throw std::invalid_argument("one array is not half as long as the other");
}

inline void coarsen(Rows<const double> fine, Rows<double> coarse) {
    expect_halves(coarse, fine);
    const auto some = [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            const double *one = fine[2 * i], *two = fine[std::min(2 * i + 1, fine.count - 1)];
            double* mean = coarse[i];
            for (Index j = 0; j < fine.length / 2; ++j)
                mean[j] = 0.25 * (one[2 * j] + two[2 * j] + one[2 * j + 1] + two[2 * j + 1]);
            const Index last = fine.length - 1;
            if (fine.length % 2) mean[last / 2] = 0.5 * (one[last] + two[last]);
        }
        return Sums{};
    };
    over_rows(some, coarse);
}

inline void refine(Rows<const double> coarse, Rows<double> fine) {
    expect_halves(coarse, fine);
    const auto some = [&](Index begin, Index end) {
        std::vector<double> padded(coarse.length + 2);
        double* row = padded.data() + 1;
        for (Index i = begin; i < end; ++i) {
            const Index beside =
                i % 2 ? std::min(i / 2 + 1, coarse.count - 1) : std::max(i / 2 - 1, Index(0));
            const double *near = coarse[i / 2], *far = coarse[beside];
            for (Index j = 0; j < coarse.length; ++j) row[j] = 0.75 * near[j] + 0.25 * far[j];
            row[-1] = row[0];
            row[coarse.length] = row[coarse.length - 1];
            double* out = fine[i];
#pragma omp simd
            for (Index j = 0; j < fine.length / 2; ++j) {
                out[2 * j] = 0.75 * row[j] + 0.25 * row[j - 1];
                out[2 * j + 1] = 0.75 * row[j] + 0.25 * row[j + 1];
            }
            const Index last = fine.length / 2;
            if (fine.length % 2) out[2 * last] = 0.75 * row[last] + 0.25 * row[last - 1];
        }
        return Sums{};
    };
    over_rows(some, fine);
}

inline void multipoles(Rows<const double> x, Rows<const double> y, Rows<const double> moments,
                       Rows<double> out) {
    if (x.count != out.count || x.length != 1 || y.count != 1 || y.length != out.length ||
        moments.count != 3 || moments.length != 3)
        throw std::invalid_argument("arrays that do not go with each other");
    const auto some = [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            const double xx = x[i][0] * x[i][0], *row = y[0];
            double* result = out[i];
#pragma omp simd
            for (Index j = 0; j < out.length; ++j) {
                const double s = 1 / (xx + row[j] * row[j]), c = xx * s;
                double sum = 0;
                for (int k = 2; k >= 0; --k)
                    sum = sum * s + ((moments[k][2] * c + moments[k][1]) * c + moments[k][0]);
                result[j] = sum * std::sqrt(s);
            }
        }
        return Sums{};
    };
    over_rows(some, out);
}

inline void spread(Rows<const Index> neighbours, Rows<const double> weights, int steps,
                   Rows<double> sums) {
    expect_one_shape(neighbours, weights);
    if (sums.count != weights.count || sums.length != 2)
        throw std::invalid_argument("arrays of different shapes");
    for (Index i = 0; i < neighbours.count; ++i)
        for (Index k = 0; k < neighbours.length; ++k)
            if (neighbours[i][k] < 0 || neighbours[i][k] >= sums.count)
                throw std::out_of_range("a neighbour that is none of the nodes");
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

inline void define_grids(py::module_& module) {
    module.def("coarsen", &coarsen);
    module.def("refine", &refine);
    module.def("multipoles", &multipoles);
    module.def("spread", &spread);
}
