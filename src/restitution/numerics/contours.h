// Nested contours of an array, in double precision. contours.py has the equivalent array expressions.

// A part lives from the level of its first node (of a merged part: of the saddle) down to the saddle
// where it merges with another part. Parts are stored after those that they have merged from.
struct ContourPart {
    Index inside, into;  // the part it belongs to now (a shortcut), and the one it merged into
    double end, sum, logs, below;
};

inline void contour_means(Rows<const double> values, bool periodic, Rows<double> out) {
    expect_one_shape(values, out);
    const Index rows = values.count, columns = values.length;
    std::vector<Index> order, home(rows * columns, -1), peak(rows * columns);
    std::vector<ContourPart> parts;
    for (Index i = 0; i < rows; ++i) {
        for (Index j = 0; j < columns; ++j) {
            out[i][j] = 0;
            if (values[i][j] > 0) order.push_back(i * columns + j);
        }
    }
    const auto at = [&](Index node) { return values[node / columns][node % columns]; };
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return at(a) > at(b); });
    const auto now = [&](Index part) {
        while (parts[part].inside != part)
            part = parts[part].inside = parts[parts[part].inside].inside;
        return part;
    };
    for (const Index node : order) {
        const Index i = node / columns, j = node % columns;
        const std::array<Index, 4> around = {
            i > 0          ? node - columns
            : periodic     ? node + (rows - 1) * columns
                           : -1,
            j > 0          ? node - 1
            : periodic     ? node + columns - 1
                           : -1,
            j < columns - 1 ? node + 1
            : periodic      ? node - columns + 1
                            : -1,
            i < rows - 1 ? node + columns
            : periodic   ? node - (rows - 1) * columns
                         : -1};
        Index first = -1, highest = -1;
        bool merges = false;
        for (const Index other : around) {
            if (other < 0 || home[other] < 0) continue;
            const Index part = now(home[other]);
            if (first < 0) first = part;
            merges = merges || part != first;
            if (highest < 0 || at(other) > at(highest)) highest = other;
        }
        Index part = first;
        if (first < 0 || merges) {
            part = Index(parts.size());
            parts.push_back({part, -1, 0, 0, 0, 0});
        }
        if (merges) {
            for (const Index other : around) {
                if (other < 0 || home[other] < 0) continue;
                const Index old = now(home[other]);
                if (old == part) continue;
                parts[old].inside = parts[old].into = part;
                parts[old].end = at(node);
            }
        }
        home[node] = part;
        peak[node] = highest < 0 ? part : peak[highest];
        parts[peak[node]].sum += at(node);
        parts[peak[node]].logs += at(node) * std::log(at(node));
    }
    for (ContourPart& part : parts) {
        if (part.into < 0) continue;
        parts[part.into].sum += part.sum;
        parts[part.into].logs += part.logs;
    }
    const auto mean = [&](const ContourPart& part, double level) {
        const double own = std::exp(1.5 * part.logs / part.sum) / std::sqrt(part.sum);
        return part.into < 0 ? own : own + part.end / level * (part.below - own);
    };
    for (Index k = Index(parts.size()) - 1; k >= 0; --k)
        if (parts[k].into >= 0) parts[k].below = mean(parts[parts[k].into], parts[k].end);
    for (const Index node : order)
        out[node / columns][node % columns] = mean(parts[home[node]], at(node));
}

inline void define_contours(py::module_& module) { module.def("contour_means", &contour_means); }
