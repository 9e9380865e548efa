#include "core/hdf5_file.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

namespace repose {
namespace {

std::vector<std::int64_t> numbers(std::int64_t first) {
  std::vector<std::int64_t> values(100);
  std::iota(values.begin(), values.end(), first);
  return values;
}

std::string file_of(std::int64_t first) {
  Hdf5Writer out(Hdf5Writer::Packing::compressed);
  out.write("/group/values", numbers(first));
  return out.bytes();
}

// HDF5 by itself takes files in memory for one and the same if their names are equal.
TEST(Hdf5File, FilesInMemoryThatAreOpenAtOnceAreNotMixedUp) {
  Hdf5Writer first(Hdf5Writer::Packing::plain), second(Hdf5Writer::Packing::plain);
  first.write("/values", numbers(1));
  second.write("/values", numbers(1000));
  const std::string first_bytes = first.bytes(), second_bytes = second.bytes();
  const Hdf5Reader a(first_bytes, "first", ""), b(second_bytes, "second", "");
  EXPECT_EQ(a.read<std::int64_t>("/values"), numbers(1));
  EXPECT_EQ(b.read<std::int64_t>("/values"), numbers(1000));
}

TEST(Hdf5File, ThreadsWriteAndReadTheirOwnFilesSideBySide) {
  constexpr int threads = 4, rounds = 200;
  std::vector<int> wrong(threads, 0);
  {
    std::vector<std::jthread> crew;
    for (int t = 0; t < threads; ++t)
      crew.emplace_back([&, t] {
        for (int i = 0; i < rounds; ++i) try {
            const std::int64_t first = 1000 * t + i;
            const std::string bytes = file_of(first);
            const Hdf5Reader in(bytes, "memory", "");
            if (in.read<std::int64_t>("/group/values") != numbers(first)) ++wrong[static_cast<std::size_t>(t)];
          } catch (const std::exception&) {
            ++wrong[static_cast<std::size_t>(t)];
          }
      });
  }
  EXPECT_EQ(wrong, std::vector<int>(threads, 0));
  EXPECT_EQ(file_of(7), file_of(7));
}

}  // namespace
}  // namespace repose
