// Vectorised convolution of an array with an even kernel. Each lane of a vector holds one column, so the
// code of a transform reads as if there were a single column. convolve.cpp describes the method and
// includes this file once for each instruction set. LANE_BYTES is the size of a vector (bytes).

template <class T>
struct Lanes {
    static constexpr int count = LANE_BYTES / sizeof(T);
    using Vector = typename VectorOf<T, count>::type;

    Vector re, im;

    Lanes operator+(const Lanes& b) const { return {re + b.re, im + b.im}; }
    Lanes operator-(const Lanes& b) const { return {re - b.re, im - b.im}; }
    Lanes operator*(T factor) const { return {re * factor, im * factor}; }
    Lanes operator*(const std::complex<T>& w) const {
        return {re * w.real() - im * w.imag(), re * w.imag() + im * w.real()};
    }
    Lanes times_i() const { return {-im, re}; }
};

// Transform r values in place: x_k = Σ_j x_j exp(∓2πi jk/r), with − forward and + backward.
template <int r, bool is_forward, class T>
inline void transform_few(Lanes<T>* x) {
    constexpr T sign = is_forward ? -1 : 1;
    if constexpr (r == 2) {
        const Lanes<T> a = x[0], b = x[1];
        x[0] = a + b;
        x[1] = a - b;
    } else if constexpr (r == 4) {
        const Lanes<T> a = x[0] + x[2], b = x[0] - x[2], c = x[1] + x[3], d = x[1] - x[3];
        const Lanes<T> e = is_forward ? Lanes<T>{d.im, -d.re} : d.times_i();
        x[0] = a + c;
        x[1] = b + e;
        x[2] = a - c;
        x[3] = b - e;
    } else {  // r is odd: the factors of x_j and x_(r−j) have the same cosines and sines
        constexpr int half = r / 2;
        const auto& cosine = ROOTS<T, r>.cosine;
        const auto& sine = ROOTS<T, r>.sine;
        const Lanes<T> first = x[0];
        Lanes<T> sum[half], difference[half];
        for (int j = 0; j < half; ++j) {
            sum[j] = x[1 + j] + x[r - 1 - j];
            difference[j] = x[1 + j] - x[r - 1 - j];
            x[0] = x[0] + sum[j];
        }
        for (int k = 1; k <= half; ++k) {
            Lanes<T> even = first, odd{};
            for (int j = 0; j < half; ++j) {
                even = even + sum[j] * cosine[(1 + j) * k % r];
                odd = odd + difference[j] * (sign * sine[(1 + j) * k % r]);
            }
            x[k] = even + odd.times_i();
            x[r - k] = even - odd.times_i();
        }
    }
}

// One stage of the transform: combine r blocks of `length` values (forward), or separate them
// again (backward).
template <int r, bool is_forward, class T>
inline void join(Lanes<T>* x, Index length, const std::complex<T>* twiddle) {
    for (Index j = 0; j < length; ++j, twiddle += r - 1) {
        Lanes<T> few[r];
        for (int k = 0; k < r; ++k) few[k] = x[j + k * length];
        if constexpr (is_forward) transform_few<r, true>(few);
        if (length > 1)
            for (int k = 1; k < r; ++k)
                few[k] = few[k] * (is_forward ? twiddle[k - 1] : std::conj(twiddle[k - 1]));
        if constexpr (!is_forward) transform_few<r, false>(few);
        for (int k = 0; k < r; ++k) x[j + k * length] = few[k];
    }
}

template <bool is_forward, class T>
void join(int radix, Lanes<T>* x, Index length, const std::complex<T>* twiddle) {
    switch (radix) {
        case 2: return join<2, is_forward>(x, length, twiddle);
        case 3: return join<3, is_forward>(x, length, twiddle);
        case 4: return join<4, is_forward>(x, length, twiddle);
        case 5: return join<5, is_forward>(x, length, twiddle);
        case 7: return join<7, is_forward>(x, length, twiddle);
    }
}

// Transform in place. The modes stay in the order in which the stages produce them (decimation in
// frequency; Gentleman and Sande 1966). `backward` inverts the stages in reverse order. Each part is
// finished before the next one begins, so that it stays in the cache.
template <class T>
void forward(const Plan<T>& plan, Lanes<T>* x, Index length, std::size_t stage = 0) {
    if (length == 1) return;
    const int radix = plan.radices[stage];
    const Index part = length / radix;
    join<true>(radix, x, part, plan.twiddles[stage].data());
    for (int k = 0; part > 1 && k < radix; ++k) forward(plan, x + k * part, part, stage + 1);
}

template <class T>
void backward(const Plan<T>& plan, Lanes<T>* x, Index length, std::size_t stage = 0) {
    if (length == 1) return;
    const int radix = plan.radices[stage];
    const Index part = length / radix;
    for (int k = 0; part > 1 && k < radix; ++k) backward(plan, x + k * part, part, stage + 1);
    join<false>(radix, x, part, plan.twiddles[stage].data());
}

// Vector whose k-th value is value number `Order::of(k, n)` of the concatenation of a and b, each of
// which has n values.
template <class Order, class Vector, int... k>
inline Vector shuffle(Vector a, Vector b, std::integer_sequence<int, k...>) {
#ifndef COMPILER_VECTORS
    constexpr int size = sizeof...(k), from[] = {Order::of(k, sizeof...(k))...};
    return Vector::of([&](int i) { return from[i] < size ? a[from[i]] : b[from[i] - size]; });
#elif __has_builtin(__builtin_shufflevector)
    return __builtin_shufflevector(a, b, Order::of(k, sizeof...(k))...);
#else
    using Whole = std::conditional_t<sizeof(a[0]) == 4, std::int32_t, std::int64_t>;
    const typename VectorOf<Whole, sizeof...(k)>::type places{Order::of(k, sizeof...(k))...};
    return __builtin_shuffle(a, b, places);
#endif
}
template <class Order, class Vector>
inline Vector shuffle(Vector a, Vector b) {
    return shuffle<Order>(a, b, std::make_integer_sequence<int, sizeof(a) / sizeof(a[0])>{});
}

struct Low {  // a0 b0 a1 b1 …
    static constexpr int of(int k, int n) { return k / 2 + k % 2 * n; }
};
struct High {  // the same for the upper halves of a and b
    static constexpr int of(int k, int n) { return (n + k) / 2 + k % 2 * n; }
};
struct Even {  // a0 a2 … b0 b2 …
    static constexpr int of(int k, int) { return 2 * k; }
};
struct Odd {
    static constexpr int of(int k, int) { return 2 * k + 1; }
};

// Transpose n vectors of n lanes.
template <int n, class Vector>
inline void transpose(Vector* x) {
    for (int step = 1; step < n; step *= 2) {
        Vector y[n];
        for (int i = 0; i < n / 2; ++i) {
            y[2 * i] = shuffle<Low>(x[i], x[i + n / 2]);
            y[2 * i + 1] = shuffle<High>(x[i], x[i + n / 2]);
        }
        for (int i = 0; i < n; ++i) x[i] = y[i];
    }
}

// Copy `some` values, but at most `most`. A copy of fixed size compiles to moves instead of a call.
template <class T, Index most>
inline void copy_some(void* to, const void* from, Index some) {
    if (some >= most)
        std::memcpy(to, from, most * sizeof(T));
    else if (some > 0)
        std::memcpy(to, from, some * sizeof(T));
}

// `load` reads `some` values of a row into a vector, and `store` writes `some` values of a vector to a
// row. Both multiply the values by a factor, which may be outside the range of single precision.
template <class T, class From>
inline typename Lanes<T>::Vector load(const From* from, double factor, Index some) {
    constexpr int count = Lanes<T>::count;
    using Exact = typename VectorOf<double, count>::type;
    using Vector = typename Lanes<T>::Vector;
    typename VectorOf<From, count>::type v{};
    copy_some<From, count>(&v, from, some);
    if (factor == 1) return CONVERTED(v, Vector);
    return CONVERTED(CONVERTED(v, Exact) * factor, Vector);
}

template <class T, class To>
inline void store(typename Lanes<T>::Vector v, double factor, To* to, Index some) {
    constexpr int count = Lanes<T>::count;
    using Exact = typename VectorOf<double, count>::type;
    using Result = typename VectorOf<To, count>::type;
    const Result result =
        factor == 1 ? CONVERTED(v, Result) : CONVERTED(CONVERTED(v, Exact) * factor, Result);
    copy_some<To, count>(to, &result, some);
}

template <class T>
inline Lanes<T> load_modes(const std::complex<T>* from, Index some) {
    typename Lanes<T>::Vector pairs[2]{};
    copy_some<std::complex<T>, Lanes<T>::count>(pairs, from, some);
    return {shuffle<Even>(pairs[0], pairs[1]), shuffle<Odd>(pairs[0], pairs[1])};
}

template <class T>
inline void store_modes(const Lanes<T>& x, std::complex<T>* to, Index some) {
    const typename Lanes<T>::Vector pairs[2] = {shuffle<Low>(x.re, x.im), shuffle<High>(x.re, x.im)};
    copy_some<std::complex<T>, Lanes<T>::count>(to, pairs, some);
}

// Transforms of a vector of columns, zero-padded to the period.
template <class T>
struct Columns {
    const Plan<T>& plan;
    Lanes<T>* x;  // array of one period

    // The caller has set x[i] for i < values.
    void transform(Index values) {
        const Index length = plan.length;
        for (Index i = values; i < length; ++i) x[i] = Lanes<T>{};
        if (plan.parts == 2) {
            for (Index i = 0; i < values; ++i) x[length + i] = x[i] * plan.half_turn[i];
            for (Index i = values; i < length; ++i) x[length + i] = Lanes<T>{};
        }
        for (int part = 0; part < plan.parts; ++part) forward(plan, x + part * length, length);
    }

    void transform_back(Index values) {
        const Index length = plan.length;
        for (int part = 0; part < plan.parts; ++part) backward(plan, x + part * length, length);
        if (plan.parts == 2)
            for (Index i = 0; i < values; ++i)
                x[i] = x[i] + x[length + i] * std::conj(plan.half_turn[i]);
    }

    Lanes<T>& wave(Index k) { return x[plan.places[k]]; }
    Lanes<T>& negative_wave(Index k) { return x[plan.places[k ? plan.period - k : 0]]; }
};

// The steps of one convolution. Modes are stored transposed: a row of modes for each column of values.
template <class T>
struct Convolution {
    static constexpr int count = Lanes<T>::count;
    using Vector = typename Lanes<T>::Vector;
    const Plan<T>&along_x, &along_y;
    Rows<const T> weights;
    Rows<std::complex<T>> modes;

    // Two blocks of real columns are transformed together as real and imaginary parts of one block.
    template <class From>
    void into_waves(Rows<const From> values, double factor, Index first, Lanes<T>* workspace) const {
        Columns<T> columns{along_x, workspace};
        for (Index i = 0; i < values.count; ++i) {
            const From* row = values[i] + first;
            columns.x[i] = {load<T>(row, factor, values.length - first),
                            load<T>(row + count, factor, values.length - first - count)};
        }
        columns.transform(values.count);
        for (Index k0 = 0; k0 < modes.length; k0 += count) {
            const Index waves = std::min<Index>(count, modes.length - k0);
            Vector re[2][count], im[2][count];
            for (Index k = 0; k < waves; ++k) {
                const Lanes<T> a = columns.wave(k0 + k), b = columns.negative_wave(k0 + k);
                re[0][k] = T(0.5) * (a.re + b.re), im[0][k] = T(0.5) * (a.im - b.im);
                re[1][k] = T(0.5) * (a.im + b.im), im[1][k] = T(0.5) * (b.re - a.re);
            }
            for (Index k = waves; k < count; ++k)
                re[0][k] = im[0][k] = re[1][k] = im[1][k] = Vector{};
            for (int block = 0; block < 2; ++block) {
                const Index column = first + block * count;
                transpose<count>(re[block]);
                transpose<count>(im[block]);
                for (Index l = 0; l < std::min<Index>(count, modes.count - column); ++l)
                    store_modes<T>({re[block][l], im[block][l]}, modes[column + l] + k0, waves);
            }
        }
    }

    template <class To>
    void out_of_waves(Rows<To> out, double factor, Index first, Lanes<T>* workspace) const {
        Columns<T> columns{along_x, workspace};
        for (Index k0 = 0; k0 < modes.length; k0 += count) {
            const Index waves = std::min<Index>(count, modes.length - k0);
            Vector re[2][count], im[2][count];
            for (int block = 0; block < 2; ++block) {
                const Index column = first + block * count;
                const Index filled = std::clamp<Index>(modes.count - column, 0, count);
                for (Index l = 0; l < filled; ++l) {
                    const Lanes<T> x = load_modes(modes[column + l] + k0, waves);
                    re[block][l] = x.re, im[block][l] = x.im;
                }
                for (Index l = filled; l < count; ++l) re[block][l] = im[block][l] = Vector{};
                transpose<count>(re[block]);
                transpose<count>(im[block]);
            }
            for (Index k = 0; k < waves; ++k) {
                columns.wave(k0 + k) = {re[0][k] - im[1][k], im[0][k] + re[1][k]};
                columns.negative_wave(k0 + k) = {re[0][k] + im[1][k], re[1][k] - im[0][k]};
            }
        }
        columns.transform_back(out.count);
        for (Index i = 0; i < out.count; ++i) {
            To* row = out[i] + first;
            store<T>(columns.x[i].re, factor, row, out.length - first);
            store<T>(columns.x[i].im, factor, row + count, out.length - first - count);
        }
    }

    void weigh(Index first, Lanes<T>* workspace) const {
        Columns<T> columns{along_y, workspace};
        const Index some = std::min<Index>(count, modes.length - first);
        for (Index i = 0; i < modes.count; ++i) columns.x[i] = load_modes(modes[i] + first, some);
        columns.transform(modes.count);
        for (Index k = 0; k < weights.count; ++k) {
            const Vector weight = load<T>(weights[k] + first, 1.0, some);
            Lanes<T>& wave = columns.wave(k);
            wave = {wave.re * weight, wave.im * weight};
            if (k == 0 || 2 * k == along_y.period) continue;
            Lanes<T>& negative = columns.negative_wave(k);
            negative = {negative.re * weight, negative.im * weight};
        }
        columns.transform_back(modes.count);
        for (Index i = 0; i < modes.count; ++i) store_modes(columns.x[i], modes[i] + first, some);
    }
};

// Compute `out` = `factor_back` · K ∗ (`factor` · `values`), a circular convolution with periods
// (px, py). `weights`, shape (py/2 + 1, px/2 + 1), is the transposed quadrant of the real, even spectrum
// of K. The size of `workspace` is at least `workspace_bytes`.
template <class From, class T, class To>
void convolve(Rows<const From> values, double factor, Rows<const T> weights, Index px, Index py,
              Rows<unsigned char> workspace, double factor_back, Rows<To> out) {
    if (out.count != values.count || out.length != values.length || weights.count != py / 2 + 1 ||
        weights.length != px / 2 + 1 ||
        workspace.length < workspace_bytes<T>(values.length, px / 2 + 1))
        throw std::invalid_argument("shapes do not match");
    const auto modes = rows_in<std::complex<T>>(workspace, values.length, px / 2 + 1);
    const auto along_x = plan_for<T>(values.count, px), along_y = plan_for<T>(values.length, py);
    const Convolution<T> convolution{*along_x, *along_y, weights, modes};
    constexpr int count = Lanes<T>::count;
    const int threads = threads_for(values.count * values.length * Index(sizeof(T)));
    const Index each = std::max(px, py);
    const auto memory = allocate(threads * each * Index(sizeof(Lanes<T>)));
    ThreadTeam team;
    team.run(threads, [&](int k) {
        Lanes<T>* its_workspace = static_cast<Lanes<T>*>(memory.get()) + k * each;
        team.parallel_for(values.length, 2 * count, [&](Index first) {
            convolution.into_waves(values, factor, first, its_workspace);
        });
        team.parallel_for(modes.length, count,
                   [&](Index first) { convolution.weigh(first, its_workspace); });
        team.parallel_for(values.length, 2 * count, [&](Index first) {
            convolution.out_of_waves(out, factor_back, first, its_workspace);
        });
    });
}

template <class From, class To>
void define_between(py::module_& module) {
    const py::call_guard<py::gil_scoped_release> without_lock;
    module.def("convolve", &convolve<From, float, To>, without_lock);
    module.def("convolve", &convolve<From, double, To>, without_lock);
}

inline void define_convolve(py::module_& module) {
    define_between<double, float>(module);
    define_between<float, float>(module);
    define_between<double, double>(module);
    define_between<float, double>(module);
    module.def("workspace_bytes", &workspace_bytes<double>);
}
