#include "core/recording.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <regex>
#include <thread>
#include <vector>

#include "core/atomic_file.hpp"
#include "core/hdf5_file.hpp"
#include "core/recording_checkpoint.hpp"
#include "core/recording_model.hpp"
#include "tests/unit/flying_world.hpp"

namespace repose {
namespace {

namespace fs = std::filesystem;

class RecordingTest : public testing::Test {
 protected:
  fs::path folder = fresh_folder("recording");
  Model model = flying_model();
  ~RecordingTest() override { fs::remove_all(folder); }

  Snapshot state_at(double time) const {
    Snapshot s = model.initial;
    s.time = time;
    for (std::size_t i = 0; i < s.size(); ++i) {
      s.position[i] += time * s.velocity[i];
      s.orientation[i] = rotation_of(time * s.angular_velocity[i]);
    }
    return s;
  }
  static StepRecord record(int k) {
    return {0.1 * k, StepReport{k, 2 * k, 1e-4 * k, k % 2 == 0, k % 3 == 0, 1e-7 * k, -1e-12 * k}};
  }
  static StepRecord record_of_a_tool_that_yields(int k) {
    StepRecord line = record(k);
    line.tool_force = Vec3(0.1, 0, 1.0 / 3) * k;
    line.tool_rise = 1e-6 / 3 * k;
    return line;
  }
  void write_run(int frames, const std::string& text = "duration: 1\n", std::uint64_t seed = 7) {
    Recorder recorder(folder, model, text, "dvi", seed, false);
    for (int k = 0; k < frames; ++k) {
      recorder.frame(state_at(0.1 * k));
      recorder.step(record(k));
      Frame frame;
      frame.step = k;
      frame.state = state_at(0.1 * k);
      frame.numbers["impulses"] = {0.1, -0.0, 1e-300};
      frame.integers["ids"] = {1, -2, std::int64_t{1} << 60};
      recorder.checkpoint(frame, 1.5 * k, false);
    }
    recorder.finish();
  }
  /// Without the cost of durability: these files are written by the hundred.
  static void spoil(const fs::path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }
  static std::string message_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const Error& problem) {
      return problem.what();
    }
    return "";
  }
};

TEST_F(RecordingTest, GivesTheModelBackToTheLastBit) {
  write_run(1);
  const Recording r = read_recording(folder / "run.h5");
  EXPECT_EQ(fingerprint(r.model), fingerprint(model));
  EXPECT_EQ(describe_model(r.model), describe_model(model));
  ASSERT_EQ(r.model.bodies.size(), model.bodies.size());
  EXPECT_EQ(r.model.laws[0], model.laws[0]);
  EXPECT_EQ(r.model.bodies[1].motion, model.bodies[1].motion);
  EXPECT_EQ(r.model.bodies[1].active.size(), 2u);
  EXPECT_EQ(r.model.bodies[1].active[1].to, 1e300);
  EXPECT_TRUE(r.model.bodies[0].active.empty());
  EXPECT_TRUE(std::isinf(r.model.bodies[0].radius));
  EXPECT_FALSE(r.model.bodies[0].dynamic);
  EXPECT_EQ(r.model.bodies[3].role, BodyRole::grain);
  EXPECT_EQ(r.model.bodies[3].mass, model.bodies[3].mass);
  EXPECT_EQ(r.model.bodies[3].inertia, model.bodies[3].inertia);
  EXPECT_TRUE(std::isinf(r.model.shapes[0].bounding_radius));
  ASSERT_EQ(r.model.shapes[1].parts.size(), model.shapes[1].parts.size());
  for (std::size_t k = 0; k < model.shapes[1].parts.size(); ++k)
    EXPECT_EQ(r.model.shapes[1].parts[k].primitive.index(), model.shapes[1].parts[k].primitive.index());
  EXPECT_TRUE(std::signbit(r.model.shapes[1].parts[0].pose.position.z()));
  EXPECT_EQ(r.model.initial.velocity[4], model.initial.velocity[4]);
  EXPECT_EQ(r.model.effects.size(), 3u);
  EXPECT_EQ(r.model.names, model.names);
}

TEST_F(RecordingTest, GivesAToolThatYieldsBack) {
  model.bodies[0].yield = Yield{1.0 / 3, 0.1};
  Recorder recorder(folder, model, "duration: 1\n", "dvi", 7, false);
  for (int k = 0; k < 3; ++k) {
    recorder.frame(state_at(0.1 * k));
    recorder.step(record_of_a_tool_that_yields(k));
  }
  Frame frame;
  frame.state = state_at(0.2);
  recorder.checkpoint(frame, 1, false);
  recorder.finish();
  const Recording r = read_recording(folder / "run.h5");
  ASSERT_TRUE(r.model.bodies[0].yield);
  EXPECT_EQ(*r.model.bodies[0].yield, *model.bodies[0].yield);
  EXPECT_FALSE(r.model.bodies[1].yield);
  ASSERT_EQ(r.steps.size(), 3u);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(r.steps[static_cast<std::size_t>(k)].tool_rise, record_of_a_tool_that_yields(k).tool_rise);
    EXPECT_EQ(r.steps[static_cast<std::size_t>(k)].tool_force, record_of_a_tool_that_yields(k).tool_force);
  }
}

TEST_F(RecordingTest, GivesFramesStepsAndSettingsBack) {
  write_run(5, "a: \"\xC2\xB5\"\n", ~std::uint64_t{0});
  const Recording r = read_recording(folder / "run.h5");
  EXPECT_EQ(r.scene_text, "a: \"\xC2\xB5\"\n");
  EXPECT_EQ(r.backend, "dvi");
  EXPECT_EQ(r.seed, ~std::uint64_t{0});
  ASSERT_EQ(r.frames.size(), 5u);
  for (int k = 0; k < 5; ++k) {
    const Snapshot wanted = state_at(0.1 * k);
    const Snapshot& got = r.frames[static_cast<std::size_t>(k)];
    EXPECT_EQ(got.time, 0.1 * k);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      EXPECT_LE((got.position[i] - wanted.position[i]).norm(), 1e-7 * wanted.position[i].norm());
      EXPECT_LE((got.velocity[i] - wanted.velocity[i]).norm(), 1e-7 * wanted.velocity[i].norm());
      EXPECT_LE((got.angular_velocity[i] - wanted.angular_velocity[i]).norm(), 1e-7 * wanted.angular_velocity[i].norm());
      EXPECT_NEAR(got.orientation[i].norm(), 1, 1e-15);
      EXPECT_NEAR(got.orientation[i].angularDistance(wanted.orientation[i]), 0, 3e-7);
    }
  }
  ASSERT_EQ(r.steps.size(), 5u);
  EXPECT_EQ(r.steps[3].time, 0.1 * 3);
  EXPECT_EQ(r.steps[3].report.contacts, 3);
  EXPECT_EQ(r.steps[3].report.iterations, 6);
  EXPECT_EQ(r.steps[3].report.residual, 1e-4 * 3);
  EXPECT_FALSE(r.steps[3].report.converged);
  EXPECT_TRUE(r.steps[3].report.cycling);
  EXPECT_EQ(r.steps[3].report.penetration, 1e-7 * 3);
  EXPECT_EQ(r.steps[3].report.contact_work, -1e-12 * 3);
}

TEST_F(RecordingTest, SkipsFramesButNotTheLast) {
  write_run(6);
  const Recording r = read_recording(folder / "run.h5", 2);
  ASSERT_EQ(r.frames.size(), 4u);
  EXPECT_EQ(r.frames[1].time, 0.1 * 2);
  EXPECT_EQ(r.frames[3].time, 0.1 * 5);
  EXPECT_THROW(read_recording(folder / "run.h5", 0), Error);
}

TEST_F(RecordingTest, SameRunSameBytes) {
  write_run(3);
  const std::string run = read_bytes(folder / "run.h5"), frame = read_bytes(folder / "frames/frame-000002.h5");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5 keeps times in seconds, if it is let
  write_run(3);
  EXPECT_TRUE(read_bytes(folder / "run.h5") == run);
  EXPECT_TRUE(read_bytes(folder / "frames/frame-000002.h5") == frame);
}

TEST_F(RecordingTest, ReadsFromElsewhereAndAfterAMove) {
  write_run(2);
  const fs::path moved = folder.string() + "-moved";
  fs::rename(folder, moved);
  EXPECT_EQ(read_recording(moved / "run.h5").frames.size(), 2u);
  fs::rename(moved, folder);
}

TEST_F(RecordingTest, NamesWhatIsMissingOrDamaged) {
  write_run(3);
  EXPECT_NE(message_of([&] { read_recording(folder / "no.h5"); }).find("no such file"), std::string::npos);
  write_atomically(folder / "text.h5", "not HDF5");
  EXPECT_NE(message_of([&] { read_recording(folder / "text.h5"); }).find("truncated"), std::string::npos);
  EXPECT_NE(message_of([&] { read_recording(folder / "frames/frame-000000.h5"); }).find("not a recording"),
            std::string::npos);
  fs::remove(folder / "frames/frame-000001.h5");
  EXPECT_NE(message_of([&] { read_recording(folder / "run.h5"); }).find("frame-000001.h5"), std::string::npos);
  const std::string whole = read_bytes(folder / "run.h5");
  for (std::size_t size = 0; size < whole.size(); size += whole.size() / 40 + 1) {
    spoil(folder / "run.h5", whole.substr(0, size));
    EXPECT_THROW(read_recording(folder / "run.h5"), Error) << "truncated to " << size;
  }
}

TEST_F(RecordingTest, ResumesFromTheNewestIntactCheckpoint) {
  write_run(5);
  const auto files = find_checkpoints(folder / "checkpoints");
  ASSERT_EQ(files.size(), 2u);
  {
    Recorder again(folder, model, "duration: 1\n", "dvi", 7, true);
    const auto resumed = again.resume();
    ASSERT_TRUE(resumed);
    EXPECT_EQ(resumed->frame.step, 4);
    EXPECT_EQ(resumed->wall_s, 6);
    EXPECT_EQ(resumed->steps.size(), 5u);
    EXPECT_EQ(resumed->warning, "");
    EXPECT_EQ(resumed->frame.numbers.at("impulses"), (std::vector<double>{0.1, -0.0, 1e-300}));
    EXPECT_TRUE(std::signbit(resumed->frame.numbers.at("impulses")[1]));
    EXPECT_EQ(resumed->frame.integers.at("ids"), (std::vector<std::int64_t>{1, -2, std::int64_t{1} << 60}));
    const Snapshot wanted = state_at(0.4);
    EXPECT_EQ(resumed->frame.state.position, wanted.position);
    EXPECT_EQ(resumed->frame.state.orientation[6].coeffs(), wanted.orientation[6].coeffs());
  }
  write_atomically(files[0], read_bytes(files[0]).substr(0, 1000));
  {
    Recorder again(folder, model, "duration: 1\n", "dvi", 7, true);
    const auto resumed = again.resume();
    ASSERT_TRUE(resumed);
    EXPECT_EQ(resumed->frame.step, 3);
    EXPECT_NE(resumed->warning.find("truncated or damaged"), std::string::npos);
    EXPECT_EQ(find_checkpoints(folder / "checkpoints").size(), 1u);
  }
  write_atomically(files[1], "");
  Recorder again(folder, model, "duration: 1\n", "dvi", 7, true);
  EXPECT_NE(message_of([&] { again.resume(); }).find("no checkpoint is intact"), std::string::npos);
}

TEST_F(RecordingTest, EveryDamagedByteOfACheckpointIsSeen) {
  write_run(1);
  const fs::path file = find_checkpoints(folder / "checkpoints").front();
  const std::string whole = read_bytes(file);
  for (std::size_t i = 0; i < whole.size(); i += 97) {
    if (i >= 60 && i < 512) continue;  // the empty rest of the header
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    spoil(file, damaged);
    EXPECT_THROW(read_checkpoint(file), Error) << "byte " << i;
  }
  for (std::size_t size = 0; size < whole.size(); size += 501) {
    spoil(file, whole.substr(0, size));
    EXPECT_THROW(read_checkpoint(file), Error) << "truncated to " << size;
  }
}

TEST_F(RecordingTest, RefusesTheCheckpointOfAnotherRun) {
  write_run(2);
  const auto attempt = [&](const Model& m, const char* text, const char* backend, std::uint64_t seed) {
    return message_of([&] { Recorder(folder, m, text, backend, seed, true).resume(); });
  };
  EXPECT_EQ(attempt(model, "duration: 1\n", "dvi", 7), "");
  EXPECT_NE(attempt(model, "duration: 1\n", "dvi", 8).find("seed 7, not 8"), std::string::npos);
  EXPECT_NE(attempt(model, "duration: 1\n", "bullet", 7).find("\"dvi\", not \"bullet\""), std::string::npos);
  EXPECT_NE(attempt(model, "duration: 2\n", "dvi", 7).find("another scene"), std::string::npos);
  EXPECT_NE(attempt(flying_model(6), "duration: 1\n", "dvi", 7).find("grains that differ"), std::string::npos);
}

TEST_F(RecordingTest, AFreshRunRemovesWhatAnEarlierOneLeft) {
  write_run(5);
  write_atomically(folder / "notes.txt", "mine");
  Recorder recorder(folder, model, "", "dvi", 7, false);
  EXPECT_FALSE(fs::exists(folder / "run.h5"));
  EXPECT_FALSE(fs::exists(folder / "run.xmf"));
  EXPECT_FALSE(fs::exists(folder / "frames/frame-000000.h5"));
  EXPECT_TRUE(fs::exists(folder / "notes.txt"));
  EXPECT_FALSE(recorder.resume());
}

TEST_F(RecordingTest, SaysWhyAFolderCannotBeWritten) {
  write_atomically(folder / "file", "");
  const std::string message = message_of([&] { Recorder(folder / "file" / "out", model, "", "dvi", 1, false); });
  EXPECT_NE(message.find("--out"), std::string::npos);
  EXPECT_THROW(write_atomically(folder / "none" / "x", "text"), Error);
}

/// Walks the tags of an XML text; "" if each is closed in order.
std::string xml_problem(const std::string& text) {
  const std::regex tag(R"re(<(/?)([A-Za-z?]+)((?:\s+[A-Za-z]+="[^"<&]*")*)\s*([/?]?)>)re");
  std::vector<std::string> open;
  std::size_t seen = 0;
  for (std::sregex_iterator i(text.begin(), text.end(), tag), end; i != end; ++i, ++seen) {
    if (!(*i)[4].str().empty()) continue;
    if ((*i)[1].str().empty()) {
      open.push_back((*i)[2]);
    } else {
      if (open.empty() || open.back() != (*i)[2].str()) return "unexpected </" + (*i)[2].str() + ">";
      open.pop_back();
    }
  }
  if (!open.empty()) return "<" + open.back() + "> is not closed";
  const auto count = static_cast<std::size_t>(std::count(text.begin(), text.end(), '<'));
  return count == seen ? "" : "malformed tags";
}

TEST_F(RecordingTest, XdmfIsWellFormedAndPointsAtDatasetsOfItsDimensions) {
  write_run(3);
  const std::string text = read_bytes(folder / "run.xmf");
  EXPECT_EQ(xml_problem(text), "");
  const std::regex item(
      R"re(<DataItem Dimensions="(\d+)(?: (\d+))?" NumberType="(\w+)" Precision="(\d)" Format="HDF">([^:]+):([^<]+)</DataItem>)re");
  int items = 0;
  for (std::sregex_iterator i(text.begin(), text.end(), item), end; i != end; ++i, ++items) {
    const auto& m = *i;
    const std::size_t rows = std::stoul(m[1]), columns = m[2].matched ? std::stoul(m[2]) : 1;
    EXPECT_EQ(rows, model.bodies.size());
    const Hdf5Reader file(folder / m[5].str());
    if (m[3] == "Float") {
      EXPECT_EQ(file.read<float>(m[6], columns, rows).size(), rows * columns) << m[6];
    } else {
      EXPECT_EQ(file.read<std::int32_t>(m[6], columns, rows).size(), rows * columns) << m[6];
    }
  }
  EXPECT_EQ(items, 3 * 8);
  const std::regex time("<Time Value=\"([^\"]+)\"/>");
  int frames = 0;
  for (std::sregex_iterator i(text.begin(), text.end(), time), end; i != end; ++i, ++frames)
    EXPECT_EQ(std::stod((*i)[1]), 0.1 * frames);
  EXPECT_EQ(frames, 3);
  for (const float radius : Hdf5Reader(folder / "run.h5").read<float>("/display/radius")) EXPECT_TRUE(std::isfinite(radius));
}

TEST_F(RecordingTest, ALargeRunKeepsEveryBody) {
  model = flying_model(100000);
  write_run(1);
  const Recording r = read_recording(folder / "run.h5");
  EXPECT_EQ(fingerprint(r.model), fingerprint(model));
  EXPECT_EQ(r.frames.at(0).size(), 100002u);
}

TEST(Hdf5File, ChecksExtents) {
  Hdf5Writer out(Hdf5Writer::Packing::compressed);
  out.write("/a/b", std::vector<float>{1, 2, 3, 4, 5, 6}, 3);
  out.write("/empty", std::vector<double>{});
  const Hdf5Reader in(out.bytes(), "memory", "remedy");
  EXPECT_EQ(in.read<float>("/a/b", 3), (std::vector<float>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(in.read<double>("/a/b", 3, 2), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_THROW(in.read<float>("/a/b", 2), Error);
  EXPECT_THROW(in.read<float>("/a/b"), Error);
  EXPECT_THROW(in.read<float>("/a/b", 3, 3), Error);
  EXPECT_THROW(in.read<float>("/c"), Error);
  EXPECT_TRUE(in.read<double>("/empty").empty());
  EXPECT_EQ(in.members("/a"), std::vector<std::string>{"b"});
  EXPECT_FALSE(in.has("/c"));
}

TEST(AtomicFile, ChecksumSeesEveryBitAndTheLength) {
  const std::string text = "0123456789abcdef0123";
  for (std::size_t bit = 0; bit < 8 * text.size(); ++bit) {
    std::string other = text;
    other[bit / 8] = static_cast<char>(other[bit / 8] ^ (1 << bit % 8));
    EXPECT_NE(checksum(other), checksum(text));
  }
  EXPECT_NE(checksum(text + '\0'), checksum(text));
  EXPECT_NE(checksum(std::string(8, '\0')), checksum(std::string(16, '\0')));
}

}  // namespace
}  // namespace repose
