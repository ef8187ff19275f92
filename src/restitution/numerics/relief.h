// Ridges and valleys, in double precision. relief.py has the equivalent array expressions.

inline void ridge_shape(Rows<const double> heights, double hx, double hy, Rows<double> out) {
    expect_one_shape(heights, out);
    const double per_xx = 1 / (hx * hx), per_yy = 1 / (hy * hy), per_xy = 1 / (4 * hx * hy);
    const Index rows = heights.count, columns = heights.length;
    const auto some = [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            double* result = out[i];
            if (i == 0 || i == rows - 1 || columns < 3) {
                std::fill(result, result + columns, 0.0);
                continue;
            }
            const double *up = heights[i - 1], *at = heights[i], *down = heights[i + 1];
            result[0] = result[columns - 1] = 0;
#pragma omp simd
            for (Index j = 1; j < columns - 1; ++j) {
                const double xx = (down[j] - 2 * at[j] + up[j]) * per_xx;
                const double yy = (at[j + 1] - 2 * at[j] + at[j - 1]) * per_yy;
                const double xy = (down[j + 1] - down[j - 1] - up[j + 1] + up[j - 1]) * per_xy;
                const double mean = 0.5 * std::abs(xx + yy);
                const double spread = std::sqrt(0.25 * (xx - yy) * (xx - yy) + xy * xy);
                const double larger = mean + spread, smaller = std::abs(mean - spread);
                const double part = larger > 0 ? 1 - smaller / larger : 0.0;
                result[j] = part * part;
            }
        }
        return Sums{};
    };
    over_rows(some, heights, out);
}

// Finds the node that follows each node. Then it follows each path to a node whose end is known, and
// stores this end for the whole path.
inline void lowest_downhill(Rows<const double> heights, Rows<double> out) {
    expect_one_shape(heights, out);
    const Index rows = heights.count, columns = heights.length;
    if (rows * columns > std::numeric_limits<std::int32_t>::max())
        throw std::invalid_argument("too many nodes");
    std::vector<std::int32_t> following(rows * columns), path;
    std::vector<double> end(rows * columns);  // of known paths, else the height
    for (Index i = 0; i < rows; ++i) {
        std::int32_t* best = following.data() + i * columns;
        double* lowest = out[i];
        std::iota(best, best + columns, std::int32_t(i * columns));
        std::copy(heights[i], heights[i] + columns, lowest);
        std::copy(heights[i], heights[i] + columns, end.data() + i * columns);
        for (Index k = std::max(i - 1, Index(0)); k <= std::min(i + 1, rows - 1); ++k) {
            for (Index shift = -1; shift <= 1; ++shift) {
                const double* row = heights[k] + shift;
                const auto node = std::int32_t(k * columns + shift);
                const Index last = columns - std::max(shift, Index(0));
#pragma omp simd
                for (Index j = std::max(-shift, Index(0)); j < last; ++j) {
                    const bool lower = row[j] < lowest[j];
                    best[j] = lower ? node + std::int32_t(j) : best[j];
                    lowest[j] = lower ? row[j] : lowest[j];
                }
            }
        }
    }
    constexpr std::int32_t known = -1;
    for (std::int32_t start = 0; start < rows * columns; ++start) {
        std::int32_t node = start;
        path.clear();
        for (; following[node] != known; node = following[node]) {
            path.push_back(node);
            if (following[node] == node) break;
        }
        for (const std::int32_t passed : path) {
            end[passed] = end[node];
            following[passed] = known;
        }
    }
    for (Index i = 0; i < rows; ++i)
        std::copy(end.data() + i * columns, end.data() + (i + 1) * columns, out[i]);
}

inline void define_relief(py::module_& module) {
    module.def("ridge_shape", &ridge_shape);
    module.def("lowest_downhill", &lowest_downhill);
}
