// An upper bound that grows with a logarithm; growing_bound.py has the equivalent array expressions.

// Natural logarithm of a positive, normal number to 1e-14, in operations that the compiler can vectorise.
inline double logarithm(double x) {
    std::int64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    const std::int64_t half = 0x3FE6A09E667F3BCD;  // √½, so that the mantissa is from √½ to √2
    const double exponent = double(int((bits - half) >> 52));
    bits -= std::int64_t(exponent) << 52;
    double mantissa;
    std::memcpy(&mantissa, &bits, sizeof mantissa);
    const double s = (mantissa - 1) / (mantissa + 1), z = s * s;  // ln m = 2 artanh s
    double series = 1.0 / 17 * z + 1.0 / 15;
    series = series * z + 1.0 / 13;
    series = series * z + 1.0 / 11;
    series = series * z + 1.0 / 9;
    series = series * z + 1.0 / 7;
    series = series * z + 1.0 / 5;
    series = series * z + 1.0 / 3;
    series = series * z + 1;
    return exponent * 0.69314718055994530942 + 2 * s * series;
}

struct ThreeSums {
    Sums two{};
    double third = 0;

    void add(const ThreeSums& other) {
        two.add(other.two);
        third += other.third;
    }
};

template <class P>
void growing_bound(Rows<const P> pressure,
                   const std::pair<Rows<const double>, Rows<const double>>& smooth,
                   const std::pair<Rows<const double>, Rows<const double>>& shape,
                   const std::pair<double, double>& depths, Rows<const double> harder,
                   const std::tuple<double, double, double, double>& constants,
                   const std::tuple<double, double, double>& of_ridge, Rows<double> out) {
    const Rows<const double> along_x = smooth.first, along_y = smooth.second;
    const Rows<const double> crest_gap = shape.first, elongation = shape.second;
    if (along_x.count != pressure.count || along_y.length != pressure.length)
        throw std::invalid_argument("arrays of different shapes");
    expect_one_shape(pressure, harder);
    const double deep = depths.first, deeper = depths.second, times = deeper / deep;
    const double onset = std::get<0>(constants), slope = std::get<1>(constants);
    const double largest = std::get<2>(constants), hardening = std::get<3>(constants);
    const double more_onset = std::get<0>(of_ridge), more_slope = std::get<1>(of_ridge);
    const double more_largest = std::get<2>(of_ridge);
    const double per_pressure = std::sqrt(times), per_onset = 1 / (per_pressure * onset);
    const auto some = [&](Index begin, Index end) {
        std::vector<double> strains(pressure.length);
        for (Index i = begin; i < end; ++i) {
            const P* p = pressure[i];
            const double *gap = crest_gap[i], *elongations = elongation[i], *across = along_y[0];
            const double* less = harder[i];
            double *bound = out[i], *strain = strains.data();
            const double here = along_x[i][0];
#pragma omp simd
            for (Index j = 0; j < pressure.length; ++j) {
                // No branches: the compiler vectorises this loop only if all alternatives are computed.
                const double given = double(p[j]), crest = gap[j], elongated = elongations[j];
                const bool touches = given > 0;
                const double counts = touches ? 1.0 : 0.0, value = touches ? given : 1.0;
                const double square = here + across[j], hertz = square > 0 ? square : 0.0;
                const double merged = std::sqrt(hertz) * per_pressure / value;
                const double rest = 1 - merged * std::sqrt(merged), apart = rest > 0 ? rest : 0.0;
                const double sunk = deep - crest, left = sunk > 1e-300 ? sunk : 1e-300;
                const double under = deeper - crest, below = touches ? under : 1.0;
                const double ridge = counts * elongated * apart, begin = 1 + more_onset * ridge;
                const double logs = logarithm(value * per_onset / begin) +
                                    apart * logarithm(times * left / below) - less[j];
                const double growth = counts * (logs > 0 ? logs : 0.0);
                const double grown = onset * begin + slope * (1 + more_slope * ridge) * growth;
                const double most = largest * (1 + more_largest * ridge);
                bound[j] = grown < most ? grown : most;
                strain[j] = growth;
            }
            if (hardening == 0) continue;
            for (Index j = 0; j < pressure.length; ++j) {
                const double merged =
                    std::sqrt(std::max(here + across[j], 0.0)) * per_pressure / double(p[j]);
                const double ridge =
                    p[j] > 0 ? elongations[j] * std::max(1 - merged * std::sqrt(merged), 0.0) : 0.0;
                bound[j] *= 1 + hardening * (1 + more_onset * ridge) * std::expm1(strain[j]);
            }
        }
        return Sums{};
    };
    over_rows(some, pressure, crest_gap, elongation, out);
}

inline std::tuple<double, double, double> step_sums(Rows<const double> now, Rows<const double> before,
                                                    Rows<const double> begun, Rows<const double> bound) {
    const auto some = [&](Index begin, Index end) {
        double whole = 0, on = 0, fresh = 0;
        for (Index i = begin; i < end; ++i) {
            const double *u = now[i], *old = before[i], *from = begun[i], *to = bound[i];
#pragma omp simd reduction(+ : whole, on, fresh)
            for (Index j = 0; j < now.length; ++j) {
                const double given = u[j] - old[j], more = given * (to[j] - from[j]);
                whole += given * from[j];
                on += old[j] > 0 ? more : 0.0;
                fresh += old[j] > 0 ? 0.0 : more;
            }
        }
        return ThreeSums{{whole, on}, fresh};
    };
    const ThreeSums sums = over_rows(some, now, before, begun, bound);
    return {sums.two.first, sums.two.second, sums.third};
}

inline void define_growing_bound(py::module_& module) {
    module.def("step_sums", &step_sums);
    module.def("growing_bound", &growing_bound<float>);
    module.def("growing_bound", &growing_bound<double>);
}
