// Threads for one operation on large arrays. They start when the operation starts and end with it.

#pragma once

#include "rows.h"

#include <array>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

// Largest number of threads; `use_threads` sets it.
inline std::atomic<int> most_threads{1};

// Total size (bytes) of the arrays of a loop, and size of the array of a transform, below which threads
// cost more time than they save. Both were measured on two cores.
constexpr Index LOOP_WORTH_THREADS = 8 << 20, BYTES_WORTH_THREADS = 4 * 350 * 350;

template <class T>
Index bytes_of(const Rows<T>& rows) {
    return (rows.stride ? rows.count : 1) * rows.length * Index(sizeof(T));
}

inline int threads_for(Index bytes) { return bytes > BYTES_WORTH_THREADS ? most_threads.load() : 1; }

// Number of times that a waiting thread polls, yielding each time, before it sleeps. On an idle machine
// 200 polls cover the time for which the first thread to finish a step waits for the last (0.1 ms). On
// a shared machine a thread may be suspended for milliseconds. More polls would then take the processor
// from threads that have work.
constexpr int LOOKS = 200;

// Threads that share the steps of an operation.
class ThreadTeam {
  public:
    // Run `work(k)` in `threads` threads, or in as many as the system provides. An exception in one
    // thread stops the steps in all of them and is rethrown here after all have ended.
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
        } catch (const std::exception&) {  // the system provides no more threads
        }
        tell([&] { count_ = int(others.size()) + 1; });
        guarded([&] { work(0); });
        for (auto& other : others) other.join();
        if (error_) std::rethrow_exception(error_);
    }

    // Call `step(i)` for i = 0, every, 2·every, … as long as i < n, each in the next free thread. Then
    // wait until all threads have finished.
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
    std::exception_ptr error_;  // the first exception thrown
    std::mutex mutex_;          // held while a condition of `wait` changes
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

// Add up the results of `some(begin, end)` over blocks of rows. The blocks and their order, and so the
// result, do not depend on the number of threads.
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
