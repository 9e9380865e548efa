#pragma once
/// Where the files of a recording bundle lie: a folder, or one HDF5 file with the same tree.
#include <filesystem>
#include <memory>
#include <string>

#include "analysis/bundle/csv_table.hpp"

namespace repose {

/// The files of a bundle, by the names that recording.yaml gives them.
class BundleFiles {
 public:
  virtual ~BundleFiles() = default;

  /// The recording's own file, for messages.
  virtual std::string recording_name() const = 0;
  /// The text of recording.yaml.
  virtual std::string recording() const = 0;
  /// The file of a scene, for messages; its folder is where the meshes lie that it names.
  virtual std::filesystem::path scene_name(const std::string& file) const = 0;
  virtual bool has_scene(const std::string& file) const = 0;
  virtual std::string scene(const std::string& file) const = 0;
  /// A table of data. Throws Error if there is none of that name.
  virtual CsvTable table(const std::string& file) const = 0;
};

/// `path`: a folder with recording.yaml, that file itself, or an HDF5 file. `root`: where the CSV files lie; empty: beside
/// recording.yaml, or inside the HDF5 file.
///
/// In an HDF5 file, `recording.yaml` and the scene are strings at the paths that they would have in the folder. Data lie at
/// the path of their CSV file, with or without `.csv`: the text of that file; or a table of records (columns: its fields);
/// or a group of lists of equal length (columns: its members). NaN and "" stand for an empty field. In a group, a single
/// string holds for all rows (`body`).
std::unique_ptr<BundleFiles> open_bundle_files(const std::filesystem::path& path, const std::filesystem::path& root);

}  // namespace repose
