// Convolution of an array with an even kernel: transforms along both axes, weights, and back.
//
// Transforms are made of some columns at a time, which stay in the cache, and zeros that only pad are
// neither stored nor transformed: n values in a period of 2 m ≥ 2 n have as their even waves those of
// a transform of length m, and as their odd ones those of the same transform of the values turned by
// half a turn over the m.

#include "rows.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <complex>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

// How to transform a period, on any processor. One of which at least half is padding is transformed
// in two parts, the even waves and the odd ones.
template <class T>
struct Plan {
    Index period;
    int parts;
    Index length;  // of a part
    std::vector<int> radices;
    std::vector<std::vector<std::complex<T>>> twiddles;  // of each stage
    std::vector<std::complex<T>> half_turn;              // exp(−πi j/length)
    std::vector<Index> places;                           // where `forward` leaves each wave

    Plan(Index period, int parts)
        : period(period), parts(parts), length(period / parts), places(period) {
        Index rest = length;
        for (int radix : {4, 2, 3, 5, 7})  // in this order the fastest of five that were tried
            for (; rest % radix == 0; rest /= radix) radices.push_back(radix);
        if (rest != 1) throw std::invalid_argument("only factors 2, 3, 5 and 7 are transformed");
        rest = length;
        for (int radix : radices) {
            auto& stage = twiddles.emplace_back();
            for (Index j = 0; j < rest / radix; ++j)
                for (int k = 1; k < radix; ++k) stage.push_back(root(j * k, rest));
            rest /= radix;
        }
        for (Index j = 0; j < length; ++j) half_turn.push_back(root(j, 2 * length));
        for (Index i = 0; i < period; ++i) {
            Index wave = i / parts;
            places[i] = i % parts * length;
            rest = length;
            for (int radix : radices) {
                rest /= radix;
                places[i] += wave % radix * rest;
                wave /= radix;
            }
        }
    }

    static std::complex<T> root(Index j, Index n) {
        return std::complex<T>(std::polar(1.0, -2 * M_PI * double(j) / double(n)));
    }
};

// cos and sin of 2πj/r.
template <class T, int r>
struct Roots {
    std::array<T, r> cosine, sine;
    Roots() {
        for (int j = 0; j < r; ++j) {
            cosine[j] = T(std::cos(2 * M_PI * j / r));
            sine[j] = T(std::sin(2 * M_PI * j / r));
        }
    }
};
template <class T, int r>
const Roots<T, r> ROOTS;

// The plan for so many values in a period. Plans are kept: making one takes longer than following it.
template <class T>
std::shared_ptr<const Plan<T>> plan_for(Index values, Index period) {
    if (values > period) throw std::invalid_argument("more values than a period holds");
    const int parts = period % 2 == 0 && 2 * values <= period ? 2 : 1;
    static std::mutex mutex;
    static std::map<std::pair<Index, int>, std::shared_ptr<const Plan<T>>> known;
    const std::lock_guard<std::mutex> lock(mutex);
    auto& plan = known[{period, parts}];
    if (!plan) plan = std::make_shared<const Plan<T>>(period, parts);
    return plan;
}

// Threads that do the same steps, each its share.
class Crew {
  public:
    // Let `work(k)` run in `threads` threads, or in as many as there are to be had.
    template <class Work>
    void run(int threads, Work work) {
        std::vector<std::thread> others;
        const auto begin = [&](int k) {
            while (count_ == 0) std::this_thread::yield();
            work(k);
        };
        try {
            for (int k = 1; k < threads; ++k) others.emplace_back(begin, k);
        } catch (const std::system_error&) {
        }
        count_ = int(others.size()) + 1;
        work(0);
        for (auto& other : others) other.join();
    }

    // `step(i)` for the k-th share of i = 0, every, 2 every, … below n; then wait for the others.
    template <class Step>
    void share(int k, Index n, Index every, Step step) {
        const Index steps = (n + every - 1) / every;
        for (Index i = steps * k / count_; i < steps * (k + 1) / count_; ++i) step(i * every);
        const int round = round_;
        if (++arrived_ == count_) {
            arrived_ = 0;
            ++round_;
        }
        while (round_ == round) std::this_thread::yield();
    }

  private:
    std::atomic<int> count_{0}, arrived_{0}, round_{0};
};

// Memory in lines of the cache.
struct Free {
    void operator()(void* memory) const { std::free(memory); }
};
inline std::unique_ptr<void, Free> room_for(std::size_t bytes) {
    constexpr std::size_t line = 64;
    std::unique_ptr<void, Free> room(std::aligned_alloc(line, (bytes + line - 1) / line * line));
    if (!room) throw std::bad_alloc();
    return room;
}

#if defined(__x86_64__)
#pragma GCC push_options
#pragma GCC target("avx2")
namespace narrow {
#define LANE_BYTES 32
#include "convolve.h"
#undef LANE_BYTES
}  // namespace narrow
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512bw,avx512vl,prefer-vector-width=512")
namespace wide {
#define LANE_BYTES 64
#include "convolve.h"
#undef LANE_BYTES
}  // namespace wide
#pragma GCC pop_options
#else
namespace narrow {
#define LANE_BYTES 16
#include "convolve.h"
#undef LANE_BYTES
}  // namespace narrow
#endif

// `out` = `factor_back` K ∗ (`factor` `values`), circular in (px, py). `weights` (py/2 + 1, px/2 + 1)
// are a quadrant of the spectrum of K, real, even and transposed; `modes` (ny, px/2 + 1) is room. The
// widest vectors of the processor are used, or the next.
template <class From, class T, class To>
void convolve(Rows<const From> values, double factor, Rows<const T> weights, Index px, Index py,
              Rows<std::complex<T>> modes, double factor_back, Rows<To> out, int threads,
              bool widest) {
    if (out.count != values.count || out.length != values.length || modes.count != values.length ||
        modes.length != px / 2 + 1 || weights.count != py / 2 + 1 || weights.length != px / 2 + 1)
        throw std::invalid_argument("arrays that do not go with each other");
    const auto along_x = plan_for<T>(values.count, px), along_y = plan_for<T>(values.length, py);
    auto how = &narrow::convolve<From, T, To>;
#if defined(__x86_64__)
    if (widest && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
        how = &wide::convolve<From, T, To>;
#endif
    how(values, factor, *along_x, *along_y, weights, modes, out, factor_back, threads);
}

template <class From, class T, class To>
void define_one(py::module_& module) {
    module.def("convolve", &convolve<From, T, To>, py::call_guard<py::gil_scoped_release>(),
               py::arg("values"), py::arg("factor"), py::arg("weights"), py::arg("px"),
               py::arg("py"), py::arg("modes"), py::arg("factor_back"), py::arg("out"),
               py::arg("threads"), py::arg("widest") = true);
}

template <class From, class To>
void define_both(py::module_& module) {
    define_one<From, float, To>(module);
    define_one<From, double, To>(module);
}

void define_convolve(py::module_& module) {
    define_both<double, float>(module);
    define_both<float, float>(module);
    define_both<double, double>(module);
    define_both<float, double>(module);
}
