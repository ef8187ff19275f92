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
void subtract_mean(Rows<T> values) {
    double sum = 0;
    for (Index i = 0; i < values.count; ++i) sum = std::accumulate(values[i], values[i] + values.length, sum);
    const T mean = T(sum / double(values.count * values.length));
    for (Index i = 0; i < values.count; ++i)
        for (Index j = 0; j < values.length; ++j) values[i][j] -= mean;
}

// x, S x, S d, z and H d.
template <class T>
using Descent = std::tuple<Rows<T>, Rows<T>, Rows<T>, Rows<T>, Rows<T>>;

template <class T>
std::pair<bool, bool> descend(Rows<T> rest, Rows<T> d, const Descent<T>& work, Rows<const T> k,
                              const py::function& product,
                              const std::tuple<double, double, double, int>& limits, bool zero_mean) {
    const auto [x, Sx, Sd, z, Hd] = work;
    const auto [enough, radius, length, most] = limits;
    expect_one_shape(rest, d, x, Sx, Sd, z, Hd, k);
    const auto as_input = [](const Rows<T>& of) { return Rows<const T>{of.first, of.count, of.length, of.stride}; };
    const Rows<const T> in_rest = as_input(rest), in_d = as_input(d), in_x = as_input(x), in_Sd = as_input(Sd);
    const Rows<const T> in_z = as_input(z), in_Hd = as_input(Hd);
    const bool inside = std::isinf(radius);
    double xSd = 0, xSx = 0, dSd = 0, rz = dot(in_rest, in_d);
    for (int i = 0; i < most; ++i) {
        const double dHd = add_curvature(in_d, in_Sd, k, Hd);
        if (!inside) dSd = dot(in_d, in_Sd), xSd = dot(in_x, in_Sd);
        const bool bent = dHd <= 0;
        double a = bent ? 0 : rz / dHd;
        const double along = bent || inside ? 0 : xSx + a * (2 * xSd + a * dSd);
        const bool at_edge = bent || along >= radius * radius;
        if (at_edge && inside)
            a = length / max_magnitude(in_d);
        else if (at_edge)
            a = (std::sqrt(std::max(xSd * xSd + dSd * (radius * radius - xSx), 0.0)) - xSd) / dSd;
        xSx = along;
        advance(x, Sx, rest, in_d, in_Sd, in_Hd, a);
        if (at_edge) return {true, bent};
        if (zero_mean) subtract_mean(rest);
        product();
        const double before = rz;
        rz = dot(in_rest, in_z);
        if (rz <= enough) break;
        redirect(d, Sd, in_z, in_rest, rz / before);
    }
    return {false, false};
}

template <class T>
double add_and_compare(Rows<const T> p, Rows<const T> slope, Rows<const T> k, double least, Rows<T> out) {
    const auto some = [&](Index begin, Index end) {
        T most = 0, doubt = 0;
        for (Index i = begin; i < end; ++i) {
            const T *pi = p[i], *si = slope[i], *ki = k[i];
            T* sum = out[i];
#pragma omp simd reduction(max : most) reduction(+ : doubt)
            for (Index j = 0; j < p.length; ++j) {
                sum[j] = pi[j] + si[j];
                const T ratio = std::abs(sum[j]) / (std::abs(ki[j]) + T(least));
                most = std::max(most, ratio);
                doubt += 0 * ratio;
            }
        }
        return Peak<T>{most, doubt};
    };
    return over_rows(some, p, slope, k, out).value();
}

template <class T>
std::tuple<Index, Index, Index, Index> ends_above(Rows<const T> values, double least) {
    Index top = values.count, bottom = 0, left = values.length, right = 0;
    const auto above = [&](T value) { return std::abs(value) > T(least); };
    for (Index i = 0; i < values.count; ++i) {
        const T* row = values[i];
        int any = 0;
#pragma omp simd reduction(| : any)
        for (Index j = 0; j < values.length; ++j) any |= above(row[j]);
        if (!any) continue;
        top = std::min(top, i), bottom = i + 1;
        left = std::find_if(row, row + left, above) - row;
        for (Index j = values.length; j > right; --j)
            if (above(row[j - 1])) right = j;
    }
    if (bottom == 0) return {0, 0, 0, 0};
    return {top, bottom, left, right};
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

inline std::pair<double, double> lennard_jones_totals(Rows<const double> gap, double shift, double least,
                                                      const std::pair<double, double>& law) {
    const double w = law.first, z0 = law.second, a = w / 3, b = 8 * w / (3 * z0);
    const auto some = [&](Index begin, Index end) {
        double energy = 0, slope = 0;
        for (Index i = begin; i < end; ++i) {
            const double* g = gap[i];
#pragma omp simd reduction(+ : energy, slope)
            for (Index j = 0; j < gap.length; ++j) {
                const double x = z0 / std::max(g[j] + shift, least), x2 = x * x, x6 = x2 * x2 * x2;
                energy -= a * x2 * (4 - x6);
                slope += b * (x2 * x) * (1 - x6);
            }
        }
        return Sums{energy, slope};
    };
    const Sums sums = over_rows(some, gap);
    return {sums.first, sums.second};
}

using Triple = std::tuple<Rows<const double>, Rows<const double>, Rows<const double>>;
using Pair = std::pair<Rows<const double>, Rows<const double>>;

inline void continued_lennard_jones(Rows<const double> base, Rows<const double> u, const Triple& ends,
                                    const std::pair<double, double>& law, Rows<double> energy,
                                    Rows<double> slope, Rows<double> stiffness) {
    const double w = law.first, z0 = law.second, a = w / 3, b = 8 * w / (3 * z0), c = 8 * w / (z0 * z0);
    const Rows<const double> least = std::get<0>(ends), bound = std::get<1>(ends);
    const Rows<const double> stiff = std::get<2>(ends);
    const auto some = [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            const double *base_i = base[i], *u_i = u[i], *least_i = least[i], *bound_i = bound[i],
                         *stiff_i = stiff[i];
            double *e = energy[i], *s = slope[i], *k = stiffness[i];
#pragma omp simd
            for (Index j = 0; j < base.length; ++j) {
                const double gap = base_i[j] + u_i[j], inside = std::max(gap, least_i[j]);
                const double below = gap - inside;
                const double x = z0 / inside, x2 = x * x, x4 = x2 * x2, x6 = x4 * x2;
                e[j] = -a * x2 * (4 - x6) + below * (0.5 * stiff_i[j] * below - bound_i[j]);
                s[j] = b * (x2 * x) * (1 - x6) + stiff_i[j] * below;
                k[j] = below < 0 ? stiff_i[j] : c * x4 * (3 * x6 - 1);
            }
        }
        return Sums{};
    };
    over_rows(some, base, u, least, bound, stiff, energy, slope, stiffness);
}

// The root of t² + c t³ = 1 for c ≥ 0, to 1e-6.
inline double repulsion_root(double c) {
    const double below = 1 / std::sqrt(1 + c), above = 1 / std::sqrt(1 + c * below);
    double t = std::sqrt(below * above);
    for (int k = 0; k < 4; ++k) {
        const double t2 = t * t;
        t -= (t2 + c * t2 * t - 1) / (2 * t + 3 * c * t2);
    }
    return t;
}

// Cube root of a positive, normal number to 1e-10.
inline double cube_root(double t) {
    std::int64_t bits;
    std::memcpy(&bits, &t, sizeof bits);
    bits = std::int64_t(int(double(int(bits >> 32)) * (1.0 / 3)) + 715094163) << 32;  // within 4 %
    double x;
    std::memcpy(&x, &bits, sizeof x);
    for (int k = 0; k < 3; ++k) x = (2 * x + t / (x * x)) * (1.0 / 3);
    return x;
}

// Nodes of a row that are far from contact are skipped, this number at a time.
constexpr Index BLOCK = 16;

inline void lennard_jones_chords(Rows<const double> base, Rows<const double> u, const Triple& known,
                                 const Pair& ends, const std::pair<double, double>& law,
                                 double least_way, Rows<double> out) {
    const Rows<const double> p = std::get<0>(known), slope = std::get<1>(known);
    const Rows<const double> stiffness = std::get<2>(known), bound = ends.first, softness = ends.second;
    const double z0 = law.second, scale = 3 * z0 / (8 * law.first);
    const auto some = [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            const double *base_i = base[i], *u_i = u[i], *p_i = p[i], *s = slope[i], *k = stiffness[i],
                         *bound_i = bound[i], *per_stiff = softness[i];
            double* result = out[i];
            for (Index from = 0; from < base.length; from += BLOCK) {
                const Index to = std::min(from + BLOCK, base.length);
                int near = 0;
#pragma omp simd reduction(| : near)
                for (Index j = from; j < to; ++j) near |= (p_i[j] > 0) | (base_i[j] + u_i[j] < z0);
                if (!near) {
                    std::copy(k + from, k + to, result + from);
                    continue;
                }
#pragma omp simd
                for (Index j = from; j < to; ++j) {
                    // No branches: the compiler vectorises this loop only if all alternatives are computed.
                    const double gap = base_i[j] + u_i[j], pressure = p_i[j], most = bound_i[j];
                    const double wanted = pressure > 0 ? pressure : 0.0;
                    const double inside = wanted < most ? wanted : most;
                    const double beyond = (wanted - inside) * per_stiff[j];
                    const double goal = z0 * cube_root(repulsion_root(inside * scale)) - beyond;
                    const double way = gap - goal, away = std::abs(way);
                    const double far = away > least_way ? 1.0 : 0.0;
                    const double repels = pressure > 0 ? 1.0 : gap < z0 ? 1.0 : 0.0;
                    const double taken = far * repels * (pressure + s[j]) / (far > 0 ? way : 1.0);
                    const double tangent = k[j];
                    result[j] = taken > 0 ? taken : tangent;
                }
            }
        }
        return Sums{};
    };
    over_rows(some, base, u, p, slope, stiffness, bound, softness, out);
}

template <class T>
void define_newton(py::module_& module) {
    module.def("descend", &descend<T>);
    module.def("add_and_compare", &add_and_compare<T>);
    module.def("ends_above", &ends_above<T>);
}

inline void define_lennard_jones(py::module_& module) {
    module.def("lennard_jones", &lennard_jones);
    module.def("lennard_jones_totals", &lennard_jones_totals);
    module.def("continued_lennard_jones", &continued_lennard_jones);
    module.def("lennard_jones_chords", &lennard_jones_chords);
}
