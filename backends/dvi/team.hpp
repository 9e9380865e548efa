#pragma once
/// A team of threads for a loop that is shared out by an `omp for` inside.
#include <algorithm>
#include <cstddef>
#include <vector>

namespace repose::dvi {

/// One copy of the loop's code, whoever calls it: the same bits at any thread count.
template <class Work>
[[gnu::noinline]] void call(Work& work) {
  work();
}

/// Calls work() on `threads` threads at once; with one thread simply here, for a parallel region of one costs an allocation
/// and a system call, several times the work of a step of a few bodies.
template <class Work>
void on_team(int threads, Work&& work) {
  if (threads <= 1) {
    call(work);
    return;
  }
#pragma omp parallel num_threads(threads)
  call(work);
}

/// work(i) for every i < n, in any order.
template <class Work>
void for_each_index(int threads, std::size_t n, Work&& work) {
  on_team(threads, [&] {
#pragma omp for schedule(static)
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(n); ++i) work(static_cast<std::size_t>(i));
  });
}

/// The same where some take much longer than others.
template <class Work>
void for_each_index_as_it_comes(int threads, std::size_t n, Work&& work) {
  on_team(threads, [&] {
#pragma omp for schedule(dynamic)
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(n); ++i) work(static_cast<std::size_t>(i));
  });
}

/// What each block of indices below n gives by gather(first, last), in order: the same at any thread count.
template <class Gather>
auto by_blocks(int threads, std::size_t n, Gather&& gather) {
  constexpr std::size_t block = 1024;
  std::vector<decltype(gather(n, n))> part((n + block - 1) / block);
  for_each_index(threads, part.size(), [&](std::size_t j) { part[j] = gather(j * block, std::min((j + 1) * block, n)); });
  return part;
}

/// Sum of term(i) over all i < n, added block by block: the same bits at any thread count.
template <class Term>
double sum_over(int threads, std::size_t n, Term&& term) {
  double sum = 0;
  for (const double part : by_blocks(threads, n, [&](std::size_t first, std::size_t last) {
         double of_block = 0;
         for (std::size_t i = first; i < last; ++i) of_block += term(i);
         return of_block;
       }))
    sum += part;
  return sum;
}

/// Largest term(i) over all i < n, and 0 at least.
template <class Term>
double most_of(int threads, std::size_t n, Term&& term) {
  double most = 0;
  for (const double part : by_blocks(threads, n, [&](std::size_t first, std::size_t last) {
         double of_block = 0;
         for (std::size_t i = first; i < last; ++i) of_block = std::max(of_block, term(i));
         return of_block;
       }))
    most = std::max(most, part);
  return most;
}

}  // namespace repose::dvi
