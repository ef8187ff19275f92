// A multipole series on a grid, in double precision; see expressions.py.

inline void multipoles(Rows<const double> x, Rows<const double> y, Rows<const double> moments,
                       Rows<double> out) {
    if (x.count != out.count || x.length != 1 || y.count != 1 || y.length != out.length ||
        moments.count != 3 || moments.length != 3)
        throw std::invalid_argument("shapes do not match");
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

inline void define_multipoles(py::module_& module) { module.def("multipoles", &multipoles); }
