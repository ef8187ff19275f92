// Threads for one step over large arrays. They are started for it and end with it.

#pragma once

#include "rows.h"

#include <array>
#include <atomic>
#include <system_error>
#include <thread>
#include <vector>

// What a step is shared among at most; one, until somebody says how many there are to be.
inline std::atomic<int> most_threads{1};

// Bytes of what a loop goes through, and of a transform, below which threads cost more than they save
// (measured on two cores).
constexpr Index LOOP_WORTH_THREADS = 8 << 20, BYTES_WORTH_THREADS = 4 * 350 * 350;

template <class T>
Index bytes_of(const Rows<T>& rows) {
    return (rows.stride ? rows.count : 1) * rows.length * Index(sizeof(T));
}

inline int threads_for(Index bytes) { return bytes > BYTES_WORTH_THREADS ? most_threads.load() : 1; }

// Threads that do the same steps together.
class ThreadTeam {
  public:
    // Let `work(k)` run in `threads` threads, or in as many as there are to be had.
    template <class Work>
    void run(int threads, Work work) {
        std::vector<std::thread> others;
        others.reserve(threads);
        const auto begin = [&](int k) {
            while (count_ == 0) std::this_thread::yield();
            work(k);
        };
        try {
            for (int k = 1; k < threads; ++k) others.emplace_back(begin, k);
        } catch (const std::system_error&) {
        }
        count_ = int(others.size()) + 1;
        work(0);
        for (auto& other : others) other.join();
    }

    // `step(i)` for i = 0, every, 2 every, … below n, by whoever is free; then wait for the others.
    template <class Step>
    void parallel_for(Index n, Index every, Step step) {
        const Index steps = (n + every - 1) / every;
        for (Index i = next_++; i < steps; i = next_++) step(i * every);
        const int round = round_;
        if (++arrived_ == count_) {
            arrived_ = 0;
            next_ = 0;
            ++round_;
        }
        while (round_ == round) std::this_thread::yield();
    }

  private:
    std::atomic<int> count_{0}, arrived_{0}, round_{0};
    std::atomic<Index> next_{0};
};

// What `some(begin, end)` finds in a few rows of these arrays at a time, added up in their order: it
// does not depend on the number of threads.
template <class Some, class First, class... Others>
auto over_rows(Some some, const First& rows, const Others&... others) {
    expect_one_shape(rows, others...);
    if ((bytes_of(rows) + ... + bytes_of(others)) < LOOP_WORTH_THREADS) return some(0, rows.count);
    constexpr Index parts = 16;
    std::array<decltype(some(0, 0)), parts> found;
    ThreadTeam team;
    team.run(most_threads, [&](int) {
        team.parallel_for(parts, 1, [&](Index k) {
            found[k] = some(k * rows.count / parts, (k + 1) * rows.count / parts);
        });
    });
    for (Index k = 1; k < parts; ++k) found[0].add(found[k]);
    return found[0];
}
