// Maxima and sums over arrays. Each type holds the partial result of a block of rows; `add` combines the
// results of two blocks.

// Largest magnitude. `doubt` sums zero times each value, so that the result is NaN if any value is not
// finite; a maximum alone would skip NaN.
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
double max_magnitude(Rows<const T> values) {
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

template <class A, class B>
double dot(Rows<const A> a, Rows<const B> b) {
    const auto some = [&](Index begin, Index end) {
        double total = 0;
        for (Index i = begin; i < end; ++i) {
            const A* ai = a[i];
            const B* bi = b[i];
#pragma omp simd reduction(+ : total)
            for (Index j = 0; j < a.length; ++j) total += double(ai[j]) * bi[j];
        }
        return Sums{total};
    };
    return over_rows(some, a, b).first;
}

template <class T>
void define_reductions(py::module_& module) {
    module.def("max_magnitude", &max_magnitude<T>);
    module.def("dot", &dot<T, float>);
    module.def("dot", &dot<T, double>);
}
