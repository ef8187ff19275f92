// A potential for each node, by a row of a table. node_tables.py has the equivalent expression.

inline void tabulated_potential(Rows<const double> gap, Rows<const Index> row, Rows<const double> nodes,
                                Rows<const double> cells, Rows<const double> ends, Rows<double> out) {
    expect_one_shape(gap, row);
    expect_one_shape(nodes, out);
    if (nodes.count != 3 * gap.count || nodes.length != gap.length)
        throw std::invalid_argument("arrays of different shapes");
    if (cells.length != 5 || ends.length != 3 || ends.count == 0 || cells.count % ends.count != 0)
        throw std::invalid_argument("tables of other shapes");
    const Index count = cells.count / ends.count;
    const Index n = gap.count;
    const auto some = [&](Index begin, Index end) {
        for (Index i = begin; i < end; ++i) {
            const double *first = nodes[i], *step = nodes[n + i], *middle = nodes[2 * n + i];
            double *energy = out[i], *traction = out[n + i], *stiffness = out[2 * n + i];
            for (Index j = 0; j < gap.length; ++j) {
                const Index k = row[i][j];
                if (k < 0 || k >= ends.count) return Sums{1};
                const double h = step[j], g = gap[i][j], last = first[j] + count * h;
                const double tail = ends[k][1], reach = last - middle[j];
                if (g > last) {
                    const double ratio = reach / (g - middle[j]), square = ratio * ratio;
                    energy[j] = 0.5 * tail * reach * square;
                    traction[j] = -tail * square * ratio;
                    stiffness[j] = 3 * tail * square * square / reach;
                    continue;
                }
                const double at = std::min((g - first[j]) / h, double(count));
                const Index cell = at > 0 ? std::min(Index(at), count - 1) : 0;
                const double t = std::max(at, 0.0) - double(cell), below = std::min(at, 0.0);
                const double* c = cells[k * count + cell];
                const double slope = c[1] + t * (2 * c[2] + 3 * t * c[3]);
                double p = c[0] + t * (c[1] + t * (c[2] + t * c[3]));
                double sum = c[4] + t * (c[0] + t * (c[1] / 2 + t * (c[2] / 3 + t * c[3] / 4)));
                sum += below * (p + 0.5 * slope * below);
                p += slope * below;
                energy[j] = (ends[k][2] - sum) * h + 0.5 * tail * reach;
                traction[j] = -p;
                stiffness[j] = -slope / h;
            }
        }
        return Sums{};
    };
    if (over_rows(some, gap).first > 0)
        throw py::index_error("a row that the tables do not have");
}

inline void define_node_tables(py::module_& module) {
    module.def("tabulated_potential", &tabulated_potential);
}
