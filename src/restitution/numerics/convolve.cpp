// Convolution of an array with an even kernel: transforms along both axes, weights, and back. What
// depends on the processor is in convolve.h.
//
// Transforms are made of some columns at a time, which stay in the cache, and zeros that only pad are
// neither stored nor transformed: n values in a period of 2 m ≥ 2 n have as their even waves those of
// a transform of length m, and as their odd ones those of the same transform of the values turned by
// half a turn over the m.

#include "crew.h"
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
        Index rest = length;  // what the stages so far have left of it
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
        return std::complex<T>(std::polar(1.0, -2 * PI * double(j) / double(n)));
    }
};

// cos and sin of 2πj/r.
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

// Memory in lines of the cache.
constexpr Index LINE = 64;

struct Free {
    void operator()(void* memory) const { ::operator delete(memory, std::align_val_t(LINE)); }
};
inline std::unique_ptr<void, Free> room_for(Index bytes) {
    return std::unique_ptr<void, Free>(::operator new(bytes, std::align_val_t(LINE)));
}

// Rows that begin with a line, an odd number of lines apart: at a power of two they would drive each
// other out of the cache.
inline Index bytes_of_row(Index bytes) { return ((bytes + LINE - 1) / LINE | 1) * LINE; }

template <class T>
Index bytes_of_room(Index rows, Index length) {
    return rows * bytes_of_row(length * Index(sizeof(std::complex<T>))) + LINE;
}

template <class T>
Rows<T> rows_in(Rows<unsigned char> room, Index rows, Index length) {
    void* first = room.first;
    std::size_t bytes = room.length;
    return {static_cast<T*>(std::align(LINE, 1, first, bytes)), rows, length,
            bytes_of_row(length * Index(sizeof(T))) / Index(sizeof(T))};
}

// Vectors of n values: the compiler's, or arrays where it has none. NO_VECTORS tries on GCC what other
// compilers get.
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
#define LOOPS "convolve.h"
#include "each_processor.h"

void define_plain_convolve(py::module_& module) { plain::define_convolve(module); }
#ifdef MANY_PROCESSORS
void define_avx2_convolve(py::module_& module) { avx2::define_convolve(module); }
void define_avx512_convolve(py::module_& module) { avx512::define_convolve(module); }
#endif
