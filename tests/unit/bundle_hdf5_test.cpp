#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "analysis/bundle/read_bundle.hpp"
#include "core/error.hpp"
#include "tests/unit/dropped_ball.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

const std::string recording_text =
    "title: Test\nscene: nominal.yaml\nruns:\n  - {id: a, observables: [{kind: trajectory, body: ball, file: runs/a.csv}]}\n";

const std::string csv_text = "time,body,x,z\n0,ball,0,1\n0.1,ball,0.03,0.95\n0.2,ball,,0.8\n";

struct Sample {
  double time;
  char body[5];
  float x;
  double z;
};
const std::vector<Sample> samples{{0, "ball", 0, 1}, {0.1, "ball", 0.03F, 0.95}, {0.2, "ball", std::nanf(""), 0.8}};

/// A bundle made with the HDF5 library itself, as other programs make theirs.
class BundleHdf5 : public ::testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() /
             ("repose-bundle-hdf5-" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder);
    fs::create_directories(folder);
    file = H5Fcreate((folder / "bundle.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    H5Gclose(H5Gcreate2(file, "/runs", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    text("/nominal.yaml", dropped_ball_scene);
    text("/recording.yaml", recording_text);
  }
  void TearDown() override { fs::remove_all(folder); }

  /// A string of variable length, as h5py writes it.
  void text(const std::string& path, const std::string& value) const {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t set = H5Dcreate2(file, path.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const char* pointer = value.c_str();
    H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &pointer);
    H5Dclose(set);
    H5Sclose(space);
    H5Tclose(type);
  }
  void list(const std::string& path, const std::vector<double>& values) const {
    const hsize_t n = values.size();
    const hid_t space = H5Screate_simple(1, &n, nullptr);
    const hid_t set = H5Dcreate2(file, path.c_str(), H5T_IEEE_F64BE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(set);
    H5Sclose(space);
  }
  void table(const std::string& path) const {
    const hid_t body = H5Tcopy(H5T_C_S1);
    H5Tset_size(body, sizeof(Sample::body));
    const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Sample));
    H5Tinsert(type, "time", HOFFSET(Sample, time), H5T_NATIVE_DOUBLE);
    H5Tinsert(type, "body", HOFFSET(Sample, body), body);
    H5Tinsert(type, "x", HOFFSET(Sample, x), H5T_NATIVE_FLOAT);
    H5Tinsert(type, "z", HOFFSET(Sample, z), H5T_NATIVE_DOUBLE);
    const hsize_t n = samples.size();
    const hid_t space = H5Screate_simple(1, &n, nullptr);
    const hid_t set = H5Dcreate2(file, path.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, samples.data());
    H5Dclose(set);
    H5Sclose(space);
    H5Tclose(type);
    H5Tclose(body);
  }
  void group(const std::string& path) const {
    H5Gclose(H5Gcreate2(file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    list(path + "/time", {0, 0.1, 0.2});
    list(path + "/x", {0, 0.03, nan});
    list(path + "/z", {1, 0.95, 0.8});
    text(path + "/body", "ball");
  }
  Bundle read() {
    H5Fclose(file);
    return read_bundle(folder / "bundle.h5");
  }
  std::string refusal() {
    try {
      read();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  void expect_the_samples(double x_slack) {
    const Bundle bundle = read();
    EXPECT_EQ(bundle.title, "Test");
    EXPECT_EQ(bundle.scene.bodies.size(), 2U);
    const Observation& o = bundle.runs.at(0).observations.at(0);
    ASSERT_EQ(o.time, (std::vector<double>{0, 0.1, 0.2}));
    EXPECT_NEAR(o.position[1].x(), 0.03, x_slack);
    EXPECT_DOUBLE_EQ(o.position[1].z(), 0.95);
    EXPECT_TRUE(std::isnan(o.position[2].x()));
    EXPECT_DOUBLE_EQ(o.position[2].z(), 0.8);
  }
  fs::path folder;
  hid_t file = -1;
};

TEST_F(BundleHdf5, DataAsCsvText) {
  text("/runs/a.csv", csv_text);
  expect_the_samples(0);
}

TEST_F(BundleHdf5, DataAsTable) {
  table("/runs/a.csv");
  expect_the_samples(1e-9);  // x is stored in single precision
}

TEST_F(BundleHdf5, DataAsGroupOfColumns) {
  group("/runs/a");
  expect_the_samples(0);
}

TEST_F(BundleHdf5, IsTheSameAsTheFolder) {
  group("/runs/a");
  const Bundle one = read();
  fs::create_directories(folder / "runs");
  std::ofstream(folder / "nominal.yaml") << dropped_ball_scene;
  std::ofstream(folder / "recording.yaml") << recording_text;
  std::ofstream(folder / "runs" / "a.csv") << csv_text;
  const Bundle other = read_bundle(folder);
  EXPECT_EQ(one.scene.text, other.scene.text);
  const Observation &a = one.runs.at(0).observations.at(0), &b = other.runs.at(0).observations.at(0);
  EXPECT_EQ(a.time, b.time);
  for (std::size_t i = 0; i < a.position.size(); ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_TRUE(a.position[i][k] == b.position[i][k] || (std::isnan(a.position[i][k]) && std::isnan(b.position[i][k])));
}

TEST_F(BundleHdf5, DataBesideTheFile) {
  fs::create_directories(folder / "data" / "runs");
  std::ofstream(folder / "data" / "runs" / "a.csv") << csv_text;
  H5Fclose(file);
  EXPECT_EQ(read_bundle(folder / "bundle.h5", folder / "data").runs.at(0).observations.at(0).time.size(), 3U);
}

TEST_F(BundleHdf5, MissingDataAreNamed) {
  const std::string message = refusal();
  EXPECT_NE(message.find("bundle.h5:runs/a.csv: no such data"), std::string::npos) << message;
}

TEST_F(BundleHdf5, ColumnsOfUnequalLengthAreRefused) {
  group("/runs/a");
  H5Ldelete(file, "/runs/a/z", H5P_DEFAULT);
  list("/runs/a/z", {1, 2});
  const std::string message = refusal();
  EXPECT_NE(message.find("column `z` has 2 rows, another 3"), std::string::npos) << message;
}

TEST_F(BundleHdf5, AMatrixIsNoTable) {
  const hsize_t extent[] = {2, 2};
  const hid_t space = H5Screate_simple(2, extent, nullptr);
  H5Dclose(H5Dcreate2(file, "/runs/a.csv", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Sclose(space);
  const std::string message = refusal();
  EXPECT_NE(message.find("neither a CSV text, nor a table, nor a group of columns"), std::string::npos) << message;
}

TEST_F(BundleHdf5, WithoutRecordingYaml) {
  H5Ldelete(file, "/recording.yaml", H5P_DEFAULT);
  const std::string message = refusal();
  EXPECT_NE(message.find("recording.yaml: this dataset is missing"), std::string::npos) << message;
  EXPECT_NE(message.find("an HDF5 bundle has the tree of a bundle's folder"), std::string::npos) << message;
}

}  // namespace
}  // namespace repose
