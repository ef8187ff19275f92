// Rows: two-dimensional arrays with contiguous rows, the arguments of the compiled loops.

#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>
#include <type_traits>

namespace py = pybind11;
using Index = py::ssize_t;

template <class T>
struct Rows {
    T* first;
    Index count, length, stride;

    T* operator[](Index i) const { return first + i * stride; }
};

template <class First, class... Others>
void expect_one_shape(const First& a, const Others&... others) {
    if (((others.count != a.count || others.length != a.length) || ...))
        throw std::invalid_argument("arrays of different shapes");
}

namespace pybind11::detail {
// Arrays are never converted: results written to a converted copy would be lost.
template <class T>
struct type_caster<Rows<T>> {
    PYBIND11_TYPE_CASTER(Rows<T>, const_name("numpy.ndarray"));

    bool load(handle source, bool) {
        using Value = std::remove_const_t<T>;
        if (!array_t<Value, 0>::check_(source)) return false;
        const auto a = reinterpret_borrow<array>(source);
        constexpr Index size = sizeof(Value);
        if (a.ndim() != 2 || (a.shape(1) > 1 && a.strides(1) != size)) return false;
        if (!std::is_const_v<T> && !a.writeable()) return false;
        value = {static_cast<T*>(const_cast<void*>(a.data())), a.shape(0), a.shape(1),
                 a.strides(0) / size};
        return true;
    }
};
}  // namespace pybind11::detail

// GCC and Clang can compile single functions for instruction sets beyond the baseline.
#if defined(__GNUC__) && defined(__x86_64__)
#define MANY_PROCESSORS
#endif

// These functions add the convolution to the module. They are defined in convolution/convolve.cpp.
void define_plain_convolve(py::module_& module);
#ifdef MANY_PROCESSORS
void define_avx2_convolve(py::module_& module);
void define_avx512_convolve(py::module_& module);
#endif
