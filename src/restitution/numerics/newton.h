// Parts of a Newton step and of its residual; see expressions.py.

template <class T>
double add_curvature(Rows<const T> d, Rows<const T> Sd, Rows<const T> k, Rows<T> out) {
    const auto some = [&](Index begin, Index end) {
        double total = 0;
        for (Index i = begin; i < end; ++i) {
            const T *di = d[i], *Si = Sd[i], *ki = k[i];
            T* result = out[i];
#pragma omp simd reduction(+ : total)
            for (Index j = 0; j < d.length; ++j) {
                result[j] = Si[j] + ki[j] * di[j];
                total += double(di[j]) * result[j];
            }
        }
        return Sums{total};
    };
    return over_rows(some, d, Sd, k, out).first;
}

template <class T>
void advance(Rows<T> x, Rows<T> Sx, Rows<T> rest, Rows<const T> d, Rows<const T> Sd, Rows<const T> Hd,
             double a) {
    const T by = T(a);
    const auto some = [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            T *xi = x[i], *Sxi = Sx[i], *ri = rest[i];
            const T *di = d[i], *Si = Sd[i], *Hi = Hd[i];
#pragma omp simd
            for (Index j = 0; j < x.length; ++j) {
                xi[j] += by * di[j];
                Sxi[j] += by * Si[j];
                ri[j] -= by * Hi[j];
            }
        }
        return Sums{};
    };
    over_rows(some, x, Sx, rest, d, Sd, Hd);
}

template <class T>
void redirect(Rows<T> d, Rows<T> Sd, Rows<const T> z, Rows<const T> rest, double b) {
    const T by = T(b);
    const auto some = [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            T *di = d[i], *Si = Sd[i];
            const T *zi = z[i], *ri = rest[i];
#pragma omp simd
            for (Index j = 0; j < d.length; ++j) {
                di[j] = by * di[j] + zi[j];
                Si[j] = by * Si[j] + ri[j];
            }
        }
        return Sums{};
    };
    over_rows(some, d, Sd, z, rest);
}

template <class T>
double largest_ratio(Rows<const T> r, Rows<const T> k, double least) {
    const auto some = [&](Index begin, Index end) {
        T most = 0, doubt = 0;
        for (Index i = begin; i < end; ++i) {
            const T *ri = r[i], *ki = k[i];
#pragma omp simd reduction(max : most) reduction(+ : doubt)
            for (Index j = 0; j < r.length; ++j) {
                const T ratio = std::abs(ri[j]) / (std::abs(ki[j]) + T(least));
                most = std::max(most, ratio);
                doubt += 0 * ratio;
            }
        }
        return Peak<T>{most, doubt};
    };
    return over_rows(some, r, k).value();
}

inline void lennard_jones(Rows<const double> gap, double w, double z0, Rows<double> energy,
                          Rows<double> slope, Rows<double> stiffness) {
    const double a = w / 3, b = 8 * w / (3 * z0), c = 8 * w / (z0 * z0);
    const auto some = [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            const double* g = gap[i];
            double *e = energy[i], *s = slope[i], *k = stiffness[i];
#pragma omp simd
            for (Index j = 0; j < gap.length; ++j) {
                const double x = z0 / g[j], x2 = x * x, x4 = x2 * x2, x6 = x4 * x2;
                e[j] = -a * x2 * (4 - x6);
                s[j] = b * (x2 * x) * (1 - x6);
                k[j] = c * x4 * (3 * x6 - 1);
            }
        }
        return Sums{};
    };
    over_rows(some, gap, energy, slope, stiffness);
}

template <class T>
void define_newton(py::module_& module) {
    module.def("add_curvature", &add_curvature<T>);
    module.def("advance", &advance<T>);
    module.def("redirect", &redirect<T>);
    module.def("largest_ratio", &largest_ratio<T>);
}

inline void define_lennard_jones(py::module_& module) { module.def("lennard_jones", &lennard_jones); }
