// Steps of the minimiser, each in one pass over memory. fused_ops.py documents the steps and has the
// equivalent array expressions. Bounds are arrays; all rows of a bound may share the same memory. The
// compiler chooses the order of summation, so that it may use vectors.

using Bounds = std::pair<Rows<const double>, Rows<const double>>;  // lower, upper

// The gradient at a node that can move downhill within its bounds; zero at other nodes.
inline double free_gradient(double p, double g, double low, double high) {
    const bool falls = (p > low) | (g < 0), rises = (p < high) | (g > 0);
    return (falls & rises) ? g : 0.0;
}

template <class T>
double projected_gradient(Rows<const double> p, Rows<double> g, Rows<const double> b,
                          const Bounds& bounds, Rows<T> out) {
    const Rows<const double> lower = bounds.first, upper = bounds.second;
    const auto some = [&](Index begin, Index end) {
        double most = 0, doubt = 0;
        for (Index i = begin; i < end; ++i) {
            const double *pi = p[i], *bi = b[i], *low = lower[i], *high = upper[i];
            double* gi = g[i];
            T* result = out[i];
#pragma omp simd reduction(max : most) reduction(+ : doubt)
            for (Index j = 0; j < p.length; ++j) {
                gi[j] -= bi[j];
                const double slope = free_gradient(pi[j], gi[j], low[j], high[j]);
                result[j] = T(slope);
                most = std::max(most, std::abs(slope));
                doubt += 0 * slope;
            }
        }
        return Peak<double>{most, doubt};
    };
    return over_rows(some, p, g, b, lower, upper, out).value();
}

template <class T>
std::pair<double, double> dot_products(Rows<const T> z, Rows<const T> r, Rows<const T> r_old) {
    const auto some = [&](Index begin, Index end) {
        double now = 0, before = 0;
        for (Index i = begin; i < end; ++i) {
            const T *zi = z[i], *ri = r[i], *old = r_old[i];
#pragma omp simd reduction(+ : now, before)
            for (Index j = 0; j < z.length; ++j) {
                now += double(ri[j]) * zi[j];
                before += double(old[j]) * zi[j];
            }
        }
        return Sums{now, before};
    };
    const Sums sums = over_rows(some, z, r, r_old);
    return {sums.first, sums.second};
}

template <class T>
std::pair<double, double> curvature(Rows<const T> d, Rows<const T> Kd) {
    const auto some = [&](Index begin, Index end) {
        double total = 0;
        T most = 0, doubt = 0;
        for (Index i = begin; i < end; ++i) {
            const T *di = d[i], *Kdi = Kd[i];
#pragma omp simd reduction(+ : total, doubt) reduction(max : most)
            for (Index j = 0; j < d.length; ++j) {
                total += double(di[j]) * Kdi[j];
                most = std::max(most, std::abs(Kdi[j]));
                doubt += 0 * Kdi[j];
            }
        }
        return SumAndPeak<T>{total, {most, doubt}};
    };
    const auto found = over_rows(some, d, Kd);
    return {found.sum, found.peak.value()};
}

template <class T>
std::pair<double, bool> projected_direction(Rows<T> d, double beta, Rows<const T> z, double length,
                                            Rows<const double> p, Rows<const double> g,
                                            Rows<const T> r, const Bounds& bounds) {
    const Rows<const double> lower = bounds.first, upper = bounds.second;
    const auto some = [&](Index begin, Index end) {
        double slope = 0, cut = 0;
        for (Index i = begin; i < end; ++i) {
            T* di = d[i];
            const double *pi = p[i], *gi = g[i], *low = lower[i], *high = upper[i];
            const T *zi = z[i], *ri = r[i];
            // No branches: the compiler vectorises this loop only if all alternatives are computed.
#pragma omp simd reduction(+ : slope, cut)
            for (Index j = 0; j < p.length; ++j) {
                const bool falls = (pi[j] > low[j]) | (gi[j] < 0);
                const bool rises = (pi[j] < high[j]) | (gi[j] > 0);
                const double to_low = low[j] - pi[j], to_high = high[j] - pi[j];
                double wanted = beta * di[j] - length * zi[j];
                wanted = (falls & rises) ? wanted : 0.0;
                double step = wanted > to_low ? wanted : to_low;
                step = step < to_high ? step : to_high;
                cut += step == wanted ? 0.0 : 1.0;
                di[j] = T(step);
                slope += double(ri[j]) * di[j];
            }
        }
        return Sums{slope, cut};
    };
    const Sums sums = over_rows(some, d, z, p, g, r, lower, upper);
    return {sums.first, sums.second > 0};
}

template <class T>
bool violates_bounds(Rows<const double> p, Rows<const T> d, double step, const Bounds& bounds) {
    const Rows<const double> lower = bounds.first, upper = bounds.second;
    expect_one_shape(p, d, lower, upper);
    for (Index i = 0; i < p.count; ++i) {
        const double *pi = p[i], *low = lower[i], *high = upper[i];
        const T* di = d[i];
        double outside = 0;
#pragma omp simd reduction(+ : outside)
        for (Index j = 0; j < p.length; ++j) {
            const double end = pi[j] + step * di[j];
            outside += ((end < low[j]) | (end > high[j])) ? 1.0 : 0.0;
        }
        if (outside > 0) return true;
    }
    return false;
}

template <bool whole, class T>
double take_step_by(Rows<double> p, Rows<double> g, Rows<const T> d, Rows<const T> Kd, double step,
                    const Bounds& bounds, Rows<T> out) {
    const Rows<const double> lower = bounds.first, upper = bounds.second;
    const auto some = [&](Index begin, Index end) {
        T most = 0, doubt = 0;
        for (Index i = begin; i < end; ++i) {
            double *pi = p[i], *gi = g[i];
            const double *low = lower[i], *high = upper[i];
            const T *di = d[i], *Kdi = Kd[i];
            T* result = out[i];
#pragma omp simd reduction(max : most) reduction(+ : doubt)
            for (Index j = 0; j < p.length; ++j) {
                double end = pi[j] + step * di[j];
                bool at_low = end < low[j], at_high = end > high[j];
                if (whole) {
                    at_low |= di[j] == T(low[j] - pi[j]);
                    at_high |= di[j] == T(high[j] - pi[j]);
                }
                end = at_low ? low[j] : end;
                end = at_high ? high[j] : end;
                const double gradient = gi[j] + step * Kdi[j];
                pi[j] = end;
                gi[j] = gradient;
                const T slope = T(free_gradient(end, gradient, low[j], high[j]));
                result[j] = slope;
                most = std::max(most, std::abs(slope));
                doubt += 0 * slope;
            }
        }
        return Peak<T>{most, doubt};
    };
    return over_rows(some, p, g, d, Kd, lower, upper, out).value();
}

template <class T>
double take_step(Rows<double> p, Rows<double> g, Rows<const T> d, Rows<const T> Kd, double step,
                 const Bounds& bounds, Rows<T> out) {
    return step == 1 ? take_step_by<true>(p, g, d, Kd, step, bounds, out)
                     : take_step_by<false>(p, g, d, Kd, step, bounds, out);
}

template <class T>
void define_fused_ops(py::module_& module) {
    module.def("projected_gradient", &projected_gradient<T>);
    module.def("dot_products", &dot_products<T>);
    module.def("curvature", &curvature<T>);
    module.def("projected_direction", &projected_direction<T>);
    module.def("violates_bounds", &violates_bounds<T>);
    module.def("take_step", &take_step<T>);
}
