// Loops over the nodes of one problem: several steps of the solver in one pass over memory. loops.cpp
// includes this once for each kind of processor.
//
// They do what the expressions of the same names in passes.py do, which say what that is. Arrays are
// (nx, ny), of double or single precision, each row in one piece; bounds are arrays, whose rows may
// all be the same one. Sums are in no fixed order, so that the compiler may use vectors.

inline double downhill_at(double p, double g, double low, double high) {
    const bool falls = (p > low) | (g < 0), rises = (p < high) | (g > 0);
    return (falls & rises) ? g : 0.0;
}

// The largest magnitude of what was seen, or NaN where `doubt` is, which sums up zero times each: a
// maximum would pass over what is not finite.
template <class T>
struct Peak {
    T most = 0, doubt = 0;

    void add(const Peak& other) {
        most = std::max(most, other.most);
        doubt += other.doubt;
    }
    double value() const { return most + doubt; }
};

struct Sums {
    double first = 0, second = 0;

    void add(const Sums& other) {
        first += other.first;
        second += other.second;
    }
};

template <class T>
double downhill(Rows<const double> p, Rows<const double> g, Rows<const double> lower,
                Rows<const double> upper, Rows<T> out) {
    const auto some = [&](Index begin, Index end) {
        T most = 0, doubt = 0;
        for (Index i = begin; i < end; ++i) {
            const double *pi = p[i], *gi = g[i], *low = lower[i], *high = upper[i];
            T* result = out[i];
#pragma omp simd reduction(max : most) reduction(+ : doubt)
            for (Index j = 0; j < p.length; ++j) {
                const T slope = T(downhill_at(pi[j], gi[j], low[j], high[j]));
                result[j] = slope;
                most = std::max(most, std::abs(slope));
                doubt += 0 * slope;
            }
        }
        return Peak<T>{most, doubt};
    };
    return over_rows(some, p, g, lower, upper, out).value();
}

template <class T>
std::pair<double, double> level(Rows<const T> r) {
    const auto some = [&](Index begin, Index end) {
        double total = 0, nodes = 0;
        for (Index i = begin; i < end; ++i) {
            const T* ri = r[i];
#pragma omp simd reduction(+ : total, nodes)
            for (Index j = 0; j < r.length; ++j) {
                total += ri[j];
                nodes += ri[j] != 0 ? 1.0 : 0.0;
            }
        }
        return Sums{total, nodes};
    };
    const Sums sums = over_rows(some, r);
    return {sums.first, sums.second};
}

template <class T>
void lower(Rows<const T> r, double by, Rows<T> out) {
    const auto some = [&, less = T(by)](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            const T* ri = r[i];
            T* result = out[i];
#pragma omp simd
            for (Index j = 0; j < r.length; ++j) {
                const T lowered = ri[j] - less;
                result[j] = ri[j] != 0 ? lowered : T(0);
            }
        }
        return Sums{};
    };
    over_rows(some, r, out);
}

template <class T>
std::pair<double, double> products(Rows<const T> z, Rows<const T> r, Rows<const T> r_old) {
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
double dot(Rows<const T> a, Rows<const T> b) {
    const auto some = [&](Index begin, Index end) {
        double total = 0;
        for (Index i = begin; i < end; ++i) {
            const T *ai = a[i], *bi = b[i];
#pragma omp simd reduction(+ : total)
            for (Index j = 0; j < a.length; ++j) total += double(ai[j]) * bi[j];
        }
        return Sums{total};
    };
    return over_rows(some, a, b).first;
}

template <class T>
std::pair<double, bool> direct(Rows<T> d, double kept, Rows<const T> z, double length,
                               Rows<const double> p, Rows<const double> g, Rows<const T> r,
                               Rows<const double> lower, Rows<const double> upper) {
    const auto some = [&](Index begin, Index end) {
        double slope = 0, cut = 0;
        for (Index i = begin; i < end; ++i) {
            T* di = d[i];
            const double *pi = p[i], *gi = g[i], *low = lower[i], *high = upper[i];
            const T *zi = z[i], *ri = r[i];
            // Without branches, and all that may be needed is computed: else it takes no vectors.
#pragma omp simd reduction(+ : slope, cut)
            for (Index j = 0; j < p.length; ++j) {
                const bool falls = (pi[j] > low[j]) | (gi[j] < 0);
                const bool rises = (pi[j] < high[j]) | (gi[j] > 0);
                const double to_low = low[j] - pi[j], to_high = high[j] - pi[j];
                double wanted = kept * di[j] - length * zi[j];
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
bool leaves(Rows<const double> p, Rows<const T> d, double taken, Rows<const double> lower,
            Rows<const double> upper) {
    expect_one_shape(p, d, lower, upper);
    for (Index i = 0; i < p.count; ++i) {
        const double *pi = p[i], *low = lower[i], *high = upper[i];
        const T* di = d[i];
        double outside = 0;
#pragma omp simd reduction(+ : outside)
        for (Index j = 0; j < p.length; ++j) {
            const double end = pi[j] + taken * di[j];
            outside += ((end < low[j]) | (end > high[j])) ? 1.0 : 0.0;
        }
        if (outside > 0) return true;
    }
    return false;
}

template <bool whole, class T>
double advance_by(Rows<double> p, Rows<double> g, Rows<const T> d, Rows<const T> Kd, double taken,
                  Rows<const double> lower, Rows<const double> upper, Rows<T> out) {
    const auto some = [&](Index begin, Index end) {
        T most = 0, doubt = 0;
        for (Index i = begin; i < end; ++i) {
            double *pi = p[i], *gi = g[i];
            const double *low = lower[i], *high = upper[i];
            const T *di = d[i], *Kdi = Kd[i];
            T* result = out[i];
#pragma omp simd reduction(max : most) reduction(+ : doubt)
            for (Index j = 0; j < p.length; ++j) {
                double end = pi[j] + taken * di[j];
                bool at_low = end < low[j], at_high = end > high[j];
                if (whole) {
                    at_low |= di[j] == T(low[j] - pi[j]);
                    at_high |= di[j] == T(high[j] - pi[j]);
                }
                end = at_low ? low[j] : end;
                end = at_high ? high[j] : end;
                const double gradient = gi[j] + taken * Kdi[j];
                pi[j] = end;
                gi[j] = gradient;
                const T slope = T(downhill_at(end, gradient, low[j], high[j]));
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
double advance(Rows<double> p, Rows<double> g, Rows<const T> d, Rows<const T> Kd, double taken,
               Rows<const double> lower, Rows<const double> upper, Rows<T> out) {
    return taken == 1 ? advance_by<true>(p, g, d, Kd, taken, lower, upper, out)
                      : advance_by<false>(p, g, d, Kd, taken, lower, upper, out);
}

template <class T>
double peak(Rows<const T> values) {
    const auto some = [&](Index begin, Index end) {
        T most = 0, doubt = 0;
        for (Index i = begin; i < end; ++i) {
            const T* its = values[i];
#pragma omp simd reduction(max : most) reduction(+ : doubt)
            for (Index j = 0; j < values.length; ++j) {
                most = std::max(most, std::abs(its[j]));
                doubt += 0 * its[j];
            }
        }
        return Peak<T>{most, doubt};
    };
    return over_rows(some, values).value();
}

template <class Coarse, class Fine>
void expect_halves(const Coarse& coarse, const Fine& fine) {
    if (coarse.count != (fine.count + 1) / 2 || coarse.length != (fine.length + 1) / 2)
        throw std::invalid_argument("one array is not half as long as the other");
}

inline void coarsen(Rows<const double> fine, Rows<double> coarse) {
    expect_halves(coarse, fine);
    for (Index i = 0; i < coarse.count; ++i) {
        const double *one = fine[2 * i], *two = fine[std::min(2 * i + 1, fine.count - 1)];
        double* mean = coarse[i];
        for (Index j = 0; j < fine.length / 2; ++j)
            mean[j] = 0.25 * (one[2 * j] + two[2 * j] + one[2 * j + 1] + two[2 * j + 1]);
        if (fine.length % 2) {
            const Index last = fine.length - 1;
            mean[last / 2] = 0.5 * (one[last] + two[last]);
        }
    }
}

inline void refine(Rows<const double> coarse, Rows<double> fine) {
    expect_halves(coarse, fine);
    const Index last = coarse.length - 1;
    std::vector<double> row(coarse.length);
    for (Index i = 0; i < fine.count; ++i) {
        const Index beside =
            i % 2 ? std::min(i / 2 + 1, coarse.count - 1) : std::max(i / 2 - 1, Index(0));
        const double *near = coarse[i / 2], *far = coarse[beside];
        for (Index j = 0; j <= last; ++j) row[j] = 0.75 * near[j] + 0.25 * far[j];
        double* out = fine[i];
        for (Index j = 0; j < fine.length; ++j) {
            const Index next = j % 2 ? std::min(j / 2 + 1, last) : std::max(j / 2 - 1, Index(0));
            out[j] = 0.75 * row[j / 2] + 0.25 * row[next];
        }
    }
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

template <class T>
void define_for(py::module_& module) {
    module.def("downhill", &downhill<T>);
    module.def("level", &level<T>);
    module.def("lower", &lower<T>);
    module.def("products", &products<T>);
    module.def("dot", &dot<T>);
    module.def("direct", &direct<T>);
    module.def("leaves", &leaves<T>);
    module.def("advance", &advance<T>);
    module.def("peak", &peak<T>);
}

inline void define_loops(py::module_& module) {
    define_for<float>(module);
    define_for<double>(module);
    module.def("coarsen", &coarsen);
    module.def("refine", &refine);
    module.def("spread", &spread);
}
