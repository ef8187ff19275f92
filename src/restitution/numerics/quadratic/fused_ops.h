// Steps of the minimiser, each in one pass over memory. fused_ops.py documents the steps and has the
// equivalent array expressions. Bounds are arrays; all rows of a bound may share the same memory. The
// compiler chooses the order of summation, so that it may use vectors.

template <class P>
using Bounds = std::pair<Rows<const P>, Rows<const P>>;  // lower, upper

// The gradient at a node that can move downhill within its bounds; zero at other nodes.
template <class P>
inline P free_gradient(P p, P g, P low, P high) {
    const bool falls = (p > low) | (g < 0), rises = (p < high) | (g > 0);
    return (falls & rises) ? g : P(0);
}

template <class P, class T>
double projected_gradient(Rows<const P> p, Rows<P> g, Rows<const P> b, const Bounds<P>& bounds,
                          Rows<T> out) {
    const Rows<const P> lower = bounds.first, upper = bounds.second;
    const auto some = [&](Index begin, Index end) {
        P most = 0, doubt = 0;
        for (Index i = begin; i < end; ++i) {
            const P *pi = p[i], *bi = b[i], *low = lower[i], *high = upper[i];
            P* gi = g[i];
            T* result = out[i];
#pragma omp simd reduction(max : most) reduction(+ : doubt)
            for (Index j = 0; j < p.length; ++j) {
                gi[j] -= bi[j];
                const P slope = free_gradient(pi[j], gi[j], low[j], high[j]);
                result[j] = T(slope);
                most = std::max(most, std::abs(slope));
                doubt += 0 * slope;
            }
        }
        return Peak<P>{most, doubt};
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

template <class P, class T>
std::pair<double, bool> projected_direction(Rows<T> d, double beta, Rows<const T> z, double length,
                                            Rows<const P> p, Rows<const P> g, Rows<const T> r,
                                            const Bounds<P>& bounds) {
    const Rows<const P> lower = bounds.first, upper = bounds.second;
    const auto some = [&](Index begin, Index end) {
        const P kept = P(beta), added = P(length);  // not captured: a store could change them
        double slope = 0;
        P cut = 0;
        for (Index i = begin; i < end; ++i) {
            T* di = d[i];
            const P *pi = p[i], *gi = g[i], *low = lower[i], *high = upper[i];
            const T *zi = z[i], *ri = r[i];
            // No branches: the compiler vectorises this loop only if all alternatives are computed.
#pragma omp simd reduction(+ : slope, cut)
            for (Index j = 0; j < p.length; ++j) {
                const bool falls = (pi[j] > low[j]) | (gi[j] < 0);
                const bool rises = (pi[j] < high[j]) | (gi[j] > 0);
                const P to_low = low[j] - pi[j], to_high = high[j] - pi[j];
                P wanted = kept * di[j] - added * zi[j];
                wanted = (falls & rises) ? wanted : P(0);
                P step = wanted > to_low ? wanted : to_low;
                step = step < to_high ? step : to_high;
                cut += step == wanted ? P(0) : P(1);
                di[j] = T(step);
                slope += double(ri[j]) * di[j];
            }
        }
        return Sums{slope, double(cut)};
    };
    const Sums sums = over_rows(some, d, z, p, g, r, lower, upper);
    return {sums.first, sums.second > 0};
}

template <class P, class T>
bool violates_bounds(Rows<const P> p, Rows<const T> d, double step, const Bounds<P>& bounds) {
    const Rows<const P> lower = bounds.first, upper = bounds.second;
    expect_one_shape(p, d, lower, upper);
    for (Index i = 0; i < p.count; ++i) {
        const P *pi = p[i], *low = lower[i], *high = upper[i];
        const T* di = d[i];
        double outside = 0;
#pragma omp simd reduction(+ : outside)
        for (Index j = 0; j < p.length; ++j) {
            const P end = pi[j] + P(step) * di[j];
            outside += ((end < low[j]) | (end > high[j])) ? 1.0 : 0.0;
        }
        if (outside > 0) return true;
    }
    return false;
}

template <bool whole, class P, class T>
double take_step_by(Rows<P> p, Rows<P> g, Rows<const T> d, Rows<const T> Kd, double length,
                    const Bounds<P>& bounds, Rows<T> out) {
    const Rows<const P> lower = bounds.first, upper = bounds.second;
    const auto some = [&](Index begin, Index end) {
        const P step = P(length);  // not captured: a store to an array could change it
        T most = 0, doubt = 0;
        for (Index i = begin; i < end; ++i) {
            P *pi = p[i], *gi = g[i];
            const P *low = lower[i], *high = upper[i];
            const T *di = d[i], *Kdi = Kd[i];
            T* result = out[i];
#pragma omp simd reduction(max : most) reduction(+ : doubt)
            for (Index j = 0; j < p.length; ++j) {
                P end = pi[j] + step * di[j];
                end = end < low[j] ? low[j] : end;
                end = end > high[j] ? high[j] : end;
                if (whole) {
                    end = di[j] == T(low[j] - pi[j]) ? low[j] : end;
                    end = di[j] == T(high[j] - pi[j]) ? high[j] : end;
                }
                const P gradient = gi[j] + step * Kdi[j];
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

template <class P, class T>
double take_step(Rows<P> p, Rows<P> g, Rows<const T> d, Rows<const T> Kd, double step,
                 const Bounds<P>& bounds, Rows<T> out) {
    return step == 1 ? take_step_by<true>(p, g, d, Kd, step, bounds, out)
                     : take_step_by<false>(p, g, d, Kd, step, bounds, out);
}

// Sum of squares, and number of values that are not zero.
template <class T>
std::pair<double, double> squares(Rows<const T> r) {
    const auto some = [&](Index begin, Index end) {
        double sum = 0, count = 0;
        for (Index i = begin; i < end; ++i) {
            const T* ri = r[i];
            T nodes = 0;
#pragma omp simd reduction(+ : sum, nodes)
            for (Index j = 0; j < r.length; ++j) {
                sum += double(ri[j]) * ri[j];
                nodes += ri[j] != 0 ? T(1) : T(0);
            }
            count += nodes;
        }
        return Sums{sum, count};
    };
    const Sums sums = over_rows(some, r);
    return {sums.first, sums.second};
}

// P is the precision of p, g and the bounds, T that of the other arrays.
template <class P, class T>
void define_steps(py::module_& module) {
    module.def("projected_gradient", &projected_gradient<P, T>);
    module.def("projected_direction", &projected_direction<P, T>);
    module.def("violates_bounds", &violates_bounds<P, T>);
    module.def("take_step", &take_step<P, T>);
}

template <class T>
void define_fused_ops(py::module_& module) {
    define_steps<double, T>(module);
    if (std::is_same_v<T, float>) define_steps<float, float>(module);
    module.def("dot_products", &dot_products<T>);
    module.def("curvature", &curvature<T>);
    module.def("squares", &squares<T>);
}
