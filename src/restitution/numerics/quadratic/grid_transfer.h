// Restriction to a coarser grid and prolongation back to the finer grid.
// grid_transfer.py has the equivalent array expressions.

template <class Coarse, class Fine>
void expect_halves(const Coarse& coarse, const Fine& fine) {
    if (coarse.count != (fine.count + 1) / 2 || coarse.length != (fine.length + 1) / 2)
        throw std::invalid_argument("the coarse array must have half as many rows and columns");
}

template <class T>
void restrict_grid(Rows<const T> fine, Rows<T> coarse) {
    expect_halves(coarse, fine);
    const auto some = [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            const T *one = fine[2 * i], *two = fine[std::min(2 * i + 1, fine.count - 1)];
            T* mean = coarse[i];
            for (Index j = 0; j < fine.length / 2; ++j)
                mean[j] = T(0.25) * (one[2 * j] + two[2 * j] + one[2 * j + 1] + two[2 * j + 1]);
            const Index last = fine.length - 1;
            if (fine.length % 2) mean[last / 2] = T(0.5) * (one[last] + two[last]);
        }
        return Sums{};
    };
    over_rows(some, coarse);
}

template <class T>
void prolong_grid(Rows<const T> coarse, Rows<T> fine) {
    expect_halves(coarse, fine);
    constexpr T most = T(0.75), rest = T(0.25);
    const auto some = [&](Index begin, Index end) {
        std::vector<T> padded(coarse.length + 2);
        T* row = padded.data() + 1;
        for (Index i = begin; i < end; ++i) {
            const Index beside =
                i % 2 ? std::min(i / 2 + 1, coarse.count - 1) : std::max(i / 2 - 1, Index(0));
            const T *near = coarse[i / 2], *far = coarse[beside];
            for (Index j = 0; j < coarse.length; ++j) row[j] = most * near[j] + rest * far[j];
            row[-1] = row[0];
            row[coarse.length] = row[coarse.length - 1];
            T* out = fine[i];
#pragma omp simd
            for (Index j = 0; j < fine.length / 2; ++j) {
                out[2 * j] = most * row[j] + rest * row[j - 1];
                out[2 * j + 1] = most * row[j] + rest * row[j + 1];
            }
            const Index last = fine.length / 2;
            if (fine.length % 2) out[2 * last] = most * row[last] + rest * row[last - 1];
        }
        return Sums{};
    };
    over_rows(some, fine);
}

template <class T>
void define_grid_transfer(py::module_& module) {
    module.def("restrict", &restrict_grid<T>);
    module.def("prolong", &prolong_grid<T>);
}
