// Convolution with an even kernel of 7 × 7 nodes; near_filter.py has the equivalent array expression.

template <class T>
void filter_near(Rows<const T> r, Rows<const double> kernel, double scale, Rows<T> out) {
    constexpr Index reach = 3;
    if (kernel.count != reach + 1 || kernel.length != reach + 1)
        throw std::invalid_argument("the quadrant of the kernel must have 4 x 4 values");
    T weight[reach + 1][reach + 1];
    for (Index k = 0; k <= reach; ++k)
        for (Index l = 0; l <= reach; ++l) weight[k][l] = T(scale * kernel[k][l]);
    const auto some = [&](Index begin, Index end) {
        T w[reach + 1][reach + 1];  // not captured: a store could change them
        std::copy(&weight[0][0], &weight[0][0] + (reach + 1) * (reach + 1), &w[0][0]);
        const Index length = r.length, padded = length + 2 * reach;
        std::vector<T> sums((reach + 1) * padded);
        T* row[reach + 1];
        for (Index k = 0; k <= reach; ++k) row[k] = sums.data() + k * padded + reach;
        const std::vector<T> nothing(length);
        for (Index i = begin; i < end; ++i) {
            std::copy(r[i], r[i] + length, row[0]);
            for (Index k = 1; k <= reach; ++k) {
                const T* above = i >= k ? r[i - k] : nothing.data();
                const T* below = i + k < r.count ? r[i + k] : nothing.data();
                for (Index j = 0; j < length; ++j) row[k][j] = above[j] + below[j];
            }
            const T *r0 = row[0], *r1 = row[1], *r2 = row[2], *r3 = row[3];
            T* result = out[i];
#pragma omp simd
            for (Index j = 0; j < length; ++j) {
                const auto across = [&](const T* values, const T* at) {
                    return at[0] * values[j] + at[1] * (values[j - 1] + values[j + 1]) +
                           at[2] * (values[j - 2] + values[j + 2]) +
                           at[3] * (values[j - 3] + values[j + 3]);
                };
                result[j] = across(r0, w[0]) + across(r1, w[1]) + across(r2, w[2]) + across(r3, w[3]);
            }
        }
        return Sums{};
    };
    over_rows(some, r, out);
}

template <class T>
void define_near_filter(py::module_& module) {
    module.def("filter_near", &filter_near<T>);
}
