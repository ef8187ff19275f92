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

template <class T>
struct SumAndPeak {
    double sum = 0;
    Peak<T> peak{};

    void add(const SumAndPeak& other) {
        sum += other.sum;
        peak.add(other.peak);
    }
};

struct Sums {
    double first = 0, second = 0;

    void add(const Sums& other) {
        first += other.first;
        second += other.second;
    }
};

template <class T>
double downhill(Rows<const double> p, Rows<double> g, Rows<const double> b,
                Rows<const double> lower, Rows<const double> upper, Rows<T> out) {
    const auto some = [&](Index begin, Index end) {
        double most = 0, doubt = 0;
        for (Index i = begin; i < end; ++i) {
            const double *pi = p[i], *bi = b[i], *low = lower[i], *high = upper[i];
            double* gi = g[i];
            T* result = out[i];
#pragma omp simd reduction(max : most) reduction(+ : doubt)
            for (Index j = 0; j < p.length; ++j) {
                gi[j] -= bi[j];
                const double slope = downhill_at(pi[j], gi[j], low[j], high[j]);
                result[j] = T(slope);
                most = std::max(most, std::abs(slope));
                doubt += 0 * slope;
            }
        }
        return Peak<double>{most, doubt};
    };
    return over_rows(some, p, g, b, lower, upper, out).value();
}

// How the nodes along an axis count to places: those of a part between the middles of the places k
// and k + 1, or beyond the last middle, by 1 − `to_next` to the one and by `to_next` to the other.
template <class T>
struct Axis {
    std::vector<Index> begin;  // of part k, and the end of all
    std::vector<T> to_next;

    Axis(Index nodes, Index places) : begin(places, nodes), to_next(nodes) {
        if (places < 2) throw std::invalid_argument("fewer places than two");
        begin[0] = 0;
        for (Index i = nodes; i-- > 0;) {
            const double x = std::clamp((i + 0.5) * places / nodes - 0.5, 0.0, places - 1.0);
            const Index k = std::min(Index(x), places - 2);
            to_next[i] = T(x - k);
            for (Index before = k; before > 0 && begin[before] > i; --before) begin[before] = i;
        }
    }
    Index parts() const { return Index(begin.size()) - 1; }
    Index part_of(Index i) const {
        return std::upper_bound(begin.begin(), begin.end() - 1, i) - begin.begin() - 1;
    }
};

// What is found at places, row by row.
struct AtPlaces {
    std::vector<double> values;

    void add(const AtPlaces& other) {
        for (std::size_t k = 0; k < values.size(); ++k) values[k] += other.values[k];
    }
};

template <class T>
void levels(Rows<const T> r, Rows<double> sums, Rows<double> nodes) {
    expect_one_shape(sums, nodes);
    const Index across = sums.length, places = sums.count * across;
    const Axis<T> along_x(r.count, sums.count), along_y(r.length, across);
    const auto some = [&](Index first, Index last) {
        AtPlaces found{std::vector<double>(2 * places)};
        // Sums down the columns of a part, by how much each row counts to its two places.
        std::vector<T> all(r.length), next(r.length), here(r.length), there(r.length);
        const auto add = [&](std::vector<T>& column, double* at) {
            for (Index l = 0; l < along_y.parts(); ++l) {
                for (Index j = along_y.begin[l]; j < along_y.begin[l + 1]; ++j) {
                    at[l] += (1 - along_y.to_next[j]) * column[j];
                    at[l + 1] += along_y.to_next[j] * column[j];
                }
            }
            std::fill(column.begin(), column.end(), T(0));
        };
        for (Index i = first; i < last;) {
            const Index k = along_x.part_of(i), end = std::min(last, along_x.begin[k + 1]);
            for (; i < end; ++i) {
                const T* ri = r[i];
                const T down = along_x.to_next[i];
#pragma omp simd
                for (Index j = 0; j < r.length; ++j) {
                    const T counts = ri[j] != 0 ? T(1) : T(0);
                    all[j] += (1 - down) * ri[j];
                    next[j] += down * ri[j];
                    here[j] += (1 - down) * counts;
                    there[j] += down * counts;
                }
            }
            double* at = found.values.data() + k * across;
            add(all, at);
            add(next, at + across);
            add(here, at + places);
            add(there, at + places + across);
        }
        return found;
    };
    const AtPlaces found = over_rows(some, r);
    for (Index k = 0; k < places; ++k) {
        sums[k / across][k % across] = found.values[k];
        nodes[k / across][k % across] = found.values[places + k];
    }
}

template <class T>
void lower(Rows<const T> r, double share, Rows<const double> sums, Rows<const double> nodes,
           Rows<T> out) {
    expect_one_shape(sums, nodes);
    const Axis<T> along_x(r.count, sums.count), along_y(r.length, sums.length);
    const auto some = [&](Index first, Index last) {
        for (Index i = first; i < last; ++i) {
            const T *ri = r[i], *to_next = along_y.to_next.data();
            T* result = out[i];
            const Index k = along_x.part_of(i);
            const double down = along_x.to_next[i];
            const auto between = [&](Rows<const double> at, Index l) {
                return (1 - down) * at[k][l] + down * at[k + 1][l];
            };
            for (Index l = 0; l < along_y.parts(); ++l) {
                const T total = T(share * between(sums, l)), count = T(between(nodes, l));
                const T more = T(share * between(sums, l + 1)) - total;
                const T further = T(between(nodes, l + 1)) - count;
#pragma omp simd
                for (Index j = along_y.begin[l]; j < along_y.begin[l + 1]; ++j) {
                    const T nearby = ri[j] != 0 ? count + further * to_next[j] : T(1);
                    const T lowered = ri[j] - (total + more * to_next[j]) / nearby;
                    result[j] = ri[j] != 0 ? lowered : T(0);
                }
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

#include "grids.h"

template <class T>
void define_for(py::module_& module) {
    module.def("downhill", &downhill<T>);
    module.def("levels", &levels<T>);
    module.def("lower", &lower<T>);
    module.def("products", &products<T>);
    module.def("curvature", &curvature<T>);
    module.def("direct", &direct<T>);
    module.def("leaves", &leaves<T>);
    module.def("advance", &advance<T>);
    module.def("peak", &peak<T>);
}

inline void define_loops(py::module_& module) {
    define_for<float>(module);
    define_for<double>(module);
    define_grids(module);
}
