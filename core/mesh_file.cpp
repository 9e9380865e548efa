#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/scene_yaml_blocks.hpp"

namespace repose {
namespace {

// "7", "7/1", "7//3": the vertex comes first; a negative index counts back from the last vertex read.
int vertex_index(const std::string& word, std::size_t vertices, const std::string& place) {
  long index = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
  const bool terminated = end == word.data() + word.size() || *end == '/';
  if (index < 0) index += static_cast<long>(vertices) + 1;
  if (error != std::errc() || !terminated || index < 1 || index > static_cast<long>(vertices))
    throw Error(place, fmt::format("`{}` is not one of the {} vertices before it", word, vertices),
                "faces name vertices by number, from 1");
  return static_cast<int>(index - 1);
}

}  // namespace

TriMesh read_obj(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) throw Error(file.string(), "is a directory", "name a file");
  std::ifstream in(file);
  if (!in) throw Error(file.string(), "cannot be read", "check its name and permissions");
  TriMesh mesh;
  std::string line, word;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::string place = fmt::format("{}:{}", file.string(), number);
    std::istringstream words(line.substr(0, line.find('#')));
    if (!(words >> word)) continue;
    if (word == "v") {
      Vec3 vertex;
      if (!(words >> vertex.x() >> vertex.y() >> vertex.z()) || !vertex.allFinite())
        throw Error(place, "a vertex is not three numbers", "write `v x y z`");
      mesh.vertices.push_back(vertex);
    } else if (word == "f") {
      std::vector<int> corners;
      while (words >> word) corners.push_back(vertex_index(word, mesh.vertices.size(), place));
      if (corners.size() < 3) throw Error(place, "a face of fewer than three corners", "write `f a b c`");
      for (std::size_t i = 2; i < corners.size(); ++i)
        mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    }
  }
  if (mesh.triangles.empty()) throw Error(file.string(), "holds no faces", "export the mesh as a text OBJ file");
  return mesh;
}

}  // namespace repose
