// Convolution of an array with an even kernel: transform along both axes, multiply by the spectrum,
// transform back. The vectorised code, which depends on the instruction set, is in convolve.h.
//
// A few columns at a time are transformed, so that they stay in the cache. Zero padding is neither
// stored nor transformed. For n values in a period of 2 m ≥ 2 n, a transform of length m gives the modes
// of even wave number. The same transform gives the modes of odd wave number if value j is first
// multiplied by exp(−πi j/m).

#include "thread_team.h"
#include "rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

constexpr double PI = 3.14159265358979323846;

// Precomputed tables for the transform of one period; they do not depend on the instruction set. If at
// least half of the period is padding, the transform has two parts: the even and the odd modes.
template <class T>
struct Plan {
    Index period;
    int parts;
    Index length;  // of one part
    std::vector<int> radices;
    std::vector<std::vector<std::complex<T>>> twiddles;  // of each stage
    std::vector<std::complex<T>> half_turn;              // exp(−πi j/length)
    std::vector<Index> places;                           // where `forward` stores each mode

    Plan(Index period, int parts)
        : period(period), parts(parts), length(period / parts), places(period) {
        Index rest = length;  // factor of the length that remains after the stages so far
        for (int radix : {4, 2, 3, 5, 7})  // the fastest of five measured orders
            for (; rest % radix == 0; rest /= radix) radices.push_back(radix);
        if (rest != 1) throw std::invalid_argument("a length may only have the factors 2, 3, 5 and 7");
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
        return std::complex<T>(std::polar(1.0, -2 * PI * double(j) / double(n)));
    }
};

// cos(2πj/r) and sin(2πj/r) for j < r, the constants of a transform of r values.
template <class T, int r>
struct Roots {
    std::array<T, r> cosine, sine;
    Roots() {
        for (int j = 0; j < r; ++j) {
            cosine[j] = T(std::cos(2 * PI * j / r));
            sine[j] = T(std::sin(2 * PI * j / r));
        }
    }
};
template <class T, int r>
const Roots<T, r> ROOTS;

// The plan for a number of `values` in a `period`. Plans are kept, because making a plan takes longer
// than a transform.
template <class T>
std::shared_ptr<const Plan<T>> plan_for(Index values, Index period) {
    if (values > period) throw std::invalid_argument("more values than the period holds");
    const int parts = period % 2 == 0 && 2 * values <= period ? 2 : 1;
    static std::mutex mutex;
    static std::map<std::pair<Index, int>, std::shared_ptr<const Plan<T>>> known;
    const std::lock_guard<std::mutex> lock(mutex);
    auto& plan = known[{period, parts}];
    if (!plan) plan = std::make_shared<const Plan<T>>(period, parts);
    return plan;
}

// Size of a cache line (bytes). Rows are aligned to cache lines.
constexpr Index LINE = 64;

struct Free {
    void operator()(void* memory) const { ::operator delete(memory, std::align_val_t(LINE)); }
};
inline std::unique_ptr<void, Free> allocate(Index bytes) {
    return std::unique_ptr<void, Free>(::operator new(bytes, std::align_val_t(LINE)));
}

// Distance between the starts of consecutive rows (bytes): an odd number of cache lines. Rows at a
// distance of a power of two would evict each other from the cache.
inline Index bytes_of_row(Index bytes) { return ((bytes + LINE - 1) / LINE | 1) * LINE; }

template <class T>
Index workspace_bytes(Index rows, Index length) {
    return rows * bytes_of_row(length * Index(sizeof(std::complex<T>))) + LINE;
}

template <class T>
Rows<T> rows_in(Rows<unsigned char> workspace, Index rows, Index length) {
    void* first = workspace.first;
    std::size_t bytes = workspace.length;
    return {static_cast<T*>(std::align(LINE, 1, first, bytes)), rows, length,
            bytes_of_row(length * Index(sizeof(T))) / Index(sizeof(T))};
}

// Vectors of n values. They are vector types of the compiler or, if the compiler has none, arrays.
// Defining NO_VECTORS selects the arrays with any compiler, for tests.
#if defined(__GNUC__) && !defined(NO_VECTORS)
#define COMPILER_VECTORS
template <class T, int n>
struct VectorOf {
    typedef T type __attribute__((vector_size(n * sizeof(T))));
};

#define CONVERTED(vector, Result) __builtin_convertvector(vector, Result)
#else
template <class T, int n>
struct Vector {
    using Value = T;
    T value[n];

    template <class Make>
    static Vector of(Make make) {
        Vector found;
        for (int k = 0; k < n; ++k) found.value[k] = make(k);
        return found;
    }
    T operator[](int k) const { return value[k]; }
    Vector operator-() const {
        return of([&](int k) { return -value[k]; });
    }
    Vector operator+(const Vector& b) const {
        return of([&](int k) { return value[k] + b[k]; });
    }
    Vector operator-(const Vector& b) const {
        return of([&](int k) { return value[k] - b[k]; });
    }
    Vector operator*(const Vector& b) const {
        return of([&](int k) { return value[k] * b[k]; });
    }
    Vector operator*(T factor) const {
        return of([&](int k) { return value[k] * factor; });
    }
    friend Vector operator*(T factor, const Vector& v) { return v * factor; }
};

template <class T, int n>
struct VectorOf {
    using type = Vector<T, n>;
};

template <class Result, class From>
inline Result converted(const From& v) {
    return Result::of([&](int k) { return typename Result::Value(v[k]); });
}
#define CONVERTED(vector, Result) converted<Result>(vector)
#endif

#ifndef __has_builtin
#define __has_builtin(name) 0
#endif
#define LOOPS "convolution/convolve.h"
#include "each_processor.h"

void define_plain_convolve(py::module_& module) { plain::define_convolve(module); }
#ifdef MANY_PROCESSORS
void define_avx2_convolve(py::module_& module) { avx2::define_convolve(module); }
void define_avx512_convolve(py::module_& module) { avx512::define_convolve(module); }
#endif
