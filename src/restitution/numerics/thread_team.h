// Threads for one step over large arrays. They are started for it and end with it.

#pragma once

#include "rows.h"

#include <array>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
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

// How often a thread that waits for others looks again, giving way each time, before it sleeps: about
// as long as threads of one step are apart on an idle machine (0.1 ms). On a shared one the others may
// be away for milliseconds, and looking for them takes the processor from whoever has work.
constexpr int LOOKS = 200;

// Threads that do the same steps together.
class ThreadTeam {
  public:
    // Let `work(k)` run in `threads` threads, or in as many as there are to be had. An exception in one
    // of them ends the steps in all, and is thrown here once they have ended.
    template <class Work>
    void run(int threads, Work work) {
        std::vector<std::thread> others;
        others.reserve(threads);
        const auto begin = [&](int k) {
            wait([&] { return count_ != 0; });
            guarded([&] { work(k); });
        };
        try {
            for (int k = 1; k < threads; ++k) others.emplace_back(begin, k);
        } catch (const std::exception&) {  // no more threads, or no memory for them
        }
        tell([&] { count_ = int(others.size()) + 1; });
        guarded([&] { work(0); });
        for (auto& other : others) other.join();
        if (error_) std::rethrow_exception(error_);
    }

    // `step(i)` for i = 0, every, 2 every, … below n, by whoever is free; then wait for the others.
    template <class Step>
    void parallel_for(Index n, Index every, Step step) {
        const Index steps = (n + every - 1) / every;
        for (Index i = next_++; i < steps && !failed_; i = next_++) step(i * every);
        const int round = round_;
        if (++arrived_ == count_) {
            tell([&] {
                arrived_ = 0;
                next_ = 0;
                ++round_;
            });
        }
        wait([&] { return round_ != round || failed_; });
    }

  private:
    std::atomic<int> count_{0}, arrived_{0}, round_{0};
    std::atomic<Index> next_{0};
    std::atomic<bool> failed_{false};
    std::exception_ptr error_;  // the first
    std::mutex mutex_;          // held while what `wait` waits for changes
    std::condition_variable changed_;

    template <class Change>
    void tell(Change change) {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            change();
        }
        changed_.notify_all();
    }

    template <class Ready>
    void wait(Ready ready) {
        for (int look = 0; look < LOOKS; ++look) {
            if (ready()) return;
            std::this_thread::yield();
        }
        std::unique_lock<std::mutex> lock(mutex_);
        changed_.wait(lock, ready);
    }

    template <class Work>
    void guarded(Work work) {
        try {
            work();
        } catch (...) {
            tell([&] {
                if (!error_) error_ = std::current_exception();
                failed_ = true;
            });
        }
    }
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
