#pragma once

#include <cstddef>
#include <functional>

namespace rimlight {

/// Bounds the threads that parallel_for may use in the whole process; 0 means all cores.
/// Call before the first parallel_for.
void set_thread_count(int threads);
int thread_count();

/// Flushes denormals to zero on the calling thread. parallel_for does it for its workers; threads
/// that compute by themselves call it once. (Denormals are slow, and differ between code paths.)
void flush_denormals();

/// Calls body(i) for i in [0, count), on all threads, in no order; returns when all are done.
/// An exception of a body is rethrown here. Results must not depend on the order: give each i its
/// own output and merge in index order afterwards.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

/// The same for a body that is no std::function yet: it stays where it is, nothing is allocated.
template <typename Body>
void parallel_for(std::size_t count, const Body& body) {
  parallel_for(count, std::function<void(std::size_t)>(std::cref(body)));
}

/// Calls body() where TBB has one thread only, this one: for libraries that use TBB inside and
/// whose result would depend on how their work is shared out.
void run_alone(const std::function<void()>& body);

}  // namespace rimlight
