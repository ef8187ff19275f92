// Local means of an array. local_mean.py documents the functions and has the equivalent array
// expressions.

// Evenly spaced places along an axis, and the linear weights with which each node contributes to them.
// Part k holds the nodes between the centres of places k and k + 1; the first and the last part also
// hold the nodes beyond the outermost centres. A node in part k has weight 1 − `to_next` at place k and
// `to_next` at place k + 1.
template <class T>
struct Axis {
    std::vector<Index> begin;  // first node of each part, and one past the last node
    std::vector<T> to_next;

    Axis(Index nodes, Index places) : begin(places, nodes), to_next(nodes) {
        if (places < 2) throw std::invalid_argument("at least two places are needed");
        begin[0] = 0;
        for (Index i = nodes; i-- > 0;) {
            const double x = std::clamp((i + 0.5) * places / nodes - 0.5, 0.0, places - 1.0);
            const Index k = std::min(Index(x), places - 2);
            to_next[i] = T(x - k);
            for (Index before = k; before > 0 && begin[before] > i; --before) begin[before] = i;
        }
    }
    Index parts() const { return Index(begin.size()) - 1; }
    Index part_of(Index i) const {
        return std::upper_bound(begin.begin(), begin.end() - 1, i) - begin.begin() - 1;
    }
};

// Sums at all places, then numbers of nonzero nodes at all places, both in row-major order.
struct PlaceSums {
    std::vector<double> values;

    void add(const PlaceSums& other) {
        for (std::size_t k = 0; k < values.size(); ++k) values[k] += other.values[k];
    }
};

template <class T>
void local_sums(Rows<const T> r, Rows<const T> mask, Rows<double> sums, Rows<double> nodes) {
    expect_one_shape(sums, nodes);
    const Index across = sums.length, places = sums.count * across;
    const Axis<T> along_x(r.count, sums.count), along_y(r.length, across);
    const auto some = [&](Index first, Index last) {
        PlaceSums found{std::vector<double>(2 * places)};
        // Weighted sums of each column over the rows of part k. `all` (for place k) and `next` (for
        // place k + 1) sum the values; `here` and `there` count the nonzero nodes in the same way.
        std::vector<T> all(r.length), next(r.length), here(r.length), there(r.length);
        const auto add = [&](std::vector<T>& column, double* at) {
            for (Index l = 0; l < along_y.parts(); ++l) {
                for (Index j = along_y.begin[l]; j < along_y.begin[l + 1]; ++j) {
                    at[l] += (1 - along_y.to_next[j]) * column[j];
                    at[l + 1] += along_y.to_next[j] * column[j];
                }
            }
            std::fill(column.begin(), column.end(), T(0));
        };
        for (Index i = first; i < last;) {
            const Index k = along_x.part_of(i), end = std::min(last, along_x.begin[k + 1]);
            for (; i < end; ++i) {
                const T *ri = r[i], *mi = mask[i];
                const T down = along_x.to_next[i];
#pragma omp simd
                for (Index j = 0; j < r.length; ++j) {
                    const T counts = mi[j] != 0 ? T(1) : T(0), value = counts * ri[j];
                    all[j] += (1 - down) * value;
                    next[j] += down * value;
                    here[j] += (1 - down) * counts;
                    there[j] += down * counts;
                }
            }
            double* at = found.values.data() + k * across;
            add(all, at);
            add(next, at + across);
            add(here, at + places);
            add(there, at + places + across);
        }
        return found;
    };
    const PlaceSums found = over_rows(some, r, mask);
    for (Index k = 0; k < places; ++k) {
        sums[k / across][k % across] = found.values[k];
        nodes[k / across][k % across] = found.values[places + k];
    }
}

template <class T>
void subtract_local_mean(Rows<const T> r, Rows<const T> mask, double share, Rows<const double> sums,
                         Rows<const double> nodes, Rows<T> out) {
    expect_one_shape(sums, nodes);
    const Axis<T> along_x(r.count, sums.count), along_y(r.length, sums.length);
    const auto some = [&](Index first, Index last) {
        for (Index i = first; i < last; ++i) {
            const T *ri = r[i], *mi = mask[i], *to_next = along_y.to_next.data();
            T* result = out[i];
            const Index k = along_x.part_of(i);
            const double down = along_x.to_next[i];
            const auto between = [&](Rows<const double> at, Index l) {
                return (1 - down) * at[k][l] + down * at[k + 1][l];
            };
            for (Index l = 0; l < along_y.parts(); ++l) {
                const T total = T(share * between(sums, l)), count = T(between(nodes, l));
                const T more = T(share * between(sums, l + 1)) - total;
                const T further = T(between(nodes, l + 1)) - count;
#pragma omp simd
                for (Index j = along_y.begin[l]; j < along_y.begin[l + 1]; ++j) {
                    const T nearby = mi[j] != 0 ? count + further * to_next[j] : T(1);
                    const T lowered = ri[j] - (total + more * to_next[j]) / nearby;
                    result[j] = mi[j] != 0 ? lowered : T(0);
                }
            }
        }
        return Sums{};
    };
    over_rows(some, r, mask, out);
}

template <class T>
void define_local_mean(py::module_& module) {
    module.def("local_sums", &local_sums<T>);
    module.def("subtract_local_mean", &subtract_local_mean<T>);
}
