#pragma once
/// A team of threads for a loop that is shared out by an `omp for` inside.

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

}  // namespace repose::dvi
