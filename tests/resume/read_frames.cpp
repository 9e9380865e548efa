/// read_frames DIR: reads every frame file that a run left, finished or not; prints how many. Exit status 1 if one cannot
/// be read. Temporary files (.partial) are not frames.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "core/hdf5_file.hpp"
#include "core/recording_state.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  int count = 0;
  try {
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(argv[1]) / "frames")) {
      if (entry.path().extension() != ".h5") continue;
      const repose::Hdf5Reader file(entry.path());
      repose::read_snapshot<float>(file, "", file.read<float>("/position", 3).size() / 3);
      ++count;
    }
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "%s\n", problem.what());
    return 1;
  }
  std::printf("%d\n", count);
}
