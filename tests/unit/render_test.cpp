#include "analysis/render/render.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "analysis/render/annotate.hpp"
#include "analysis/render/grain_colours.hpp"
#include "analysis/render/intersect.hpp"
#include "analysis/render/palette.hpp"
#include "analysis/render/ray_scene.hpp"
#include "core/error.hpp"
#include "tests/unit/picture_heap.hpp"

namespace repose {
namespace {

using test::ModelBuilder;

double distance_to(const Primitive& primitive, const Vec3& origin, const Vec3& direction) {
  SurfaceHit hit;
  return intersect(primitive, origin, direction, 0, 1e9, hit) ? hit.distance : -1;
}

TriMesh cube_mesh(double h) {
  TriMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.vertices.push_back({i & 1 ? h : -h, i & 2 ? h : -h, i & 4 ? h : -h});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// A funnel-like ring with a slanted inside, a flat top and a cylindrical outside.
Revolved ring_profile() { return {{{0.5, -0.5}, {1.2, -0.5}, {1.2, 0.6}, {0.9, 0.6}}}; }

std::vector<Primitive> bounded_primitives() {
  return {Sphere{0.8},
          Ellipsoid{{1.2, 0.5, 0.7}},
          RoundCone{0.6, 0, 1.2},
          RoundCone{0.4, 0.7, 0.9},
          RoundCone{0.8, 0.1, 0.9},
          Cone{0.9, 1.3},
          Box{{0.5, 0.8, 0.3}},
          Cylinder{0.7, 0.9},
          ring_profile(),
          cube_mesh(0.7)};
}

TEST(Intersect, closed_form_distances) {
  EXPECT_DOUBLE_EQ(distance_to(Sphere{2}, {0, 0, 5}, {0, 0, -1}), 3);
  EXPECT_DOUBLE_EQ(distance_to(Ellipsoid{{3, 1, 1}}, {10, 0, 0}, {-1, 0, 0}), 7);
  EXPECT_DOUBLE_EQ(distance_to(Box{{1, 2, 3}}, {0, 5, 0}, {0, -1, 0}), 3);
  EXPECT_DOUBLE_EQ(distance_to(Cylinder{1, 2}, {5, 0, 1}, {-1, 0, 0}), 4);
  EXPECT_DOUBLE_EQ(distance_to(Cylinder{1, 2}, {0.5, 0, 5}, {0, 0, -1}), 3);
  EXPECT_DOUBLE_EQ(distance_to(Cone{1, 2}, {5, 0, 1}, {-1, 0, 0}), 4.5);
  EXPECT_DOUBLE_EQ(distance_to(HalfSpace{Vec3::UnitZ()}, {3, 4, 5}, {0, 0, -1}), 5);
  EXPECT_DOUBLE_EQ(distance_to(HalfSpace{Vec3::UnitZ()}, {3, 4, 5}, {0, 0, 1}), -1);
  EXPECT_DOUBLE_EQ(distance_to(cube_mesh(1), {0.2, 0.3, 4}, {0, 0, -1}), 3);
  // The apex of a sphere with its tangent cone, and the side where the cone is a line at the sine of its opening.
  EXPECT_NEAR(distance_to(RoundCone{1, 0, 2}, {5, 0, 0}, {-1, 0, 0}), 3, 1e-12);
  const double x = 1.2, side = (2 - x) * std::tan(std::asin(0.5));
  EXPECT_NEAR(distance_to(RoundCone{1, 0, 2}, {x, 5, 0}, {0, -1, 0}), 5 - side, 1e-12);
  EXPECT_DOUBLE_EQ(distance_to(RoundCone{0.8, 0.1, 0.3}, {5, 0, 0}, {-1, 0, 0}), 4.2);  // one sphere holds the other
  // Through the hole of a ring, and onto its slanted inside: r = 0.5 + 0.4 (z + 0.5) / 1.1.
  EXPECT_DOUBLE_EQ(distance_to(ring_profile(), {0.3, 0, 3}, {0, 0, -1}), -1);
  EXPECT_NEAR(distance_to(ring_profile(), {0, 0, 0}, {1, 0, 0}), 0.5 + 0.4 * 0.5 / 1.1, 1e-12);
  EXPECT_NEAR(distance_to(ring_profile(), {1, 0, 3}, {0, 0, -1}), 2.4, 1e-12);
}

/// Just before the hit a ray is outside, just behind it is inside, and a ray without hit never enters: by contains().
TEST(Intersect, agrees_with_contains_along_random_rays) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vec3(normal(random), normal(random), normal(random)).normalized(); };
  for (const Primitive& primitive : bounded_primitives()) {
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 origin = 4 * direction();
      const Vec3 ray = (1.1 * std::cbrt(std::uniform_real_distribution<double>(0, 1)(random)) * direction() - origin);
      SurfaceHit hit;
      const bool found = intersect(primitive, origin, ray, 0, 1e9, hit);
      const double end = found ? hit.distance : 2;
      for (int k = 0; k < 40; ++k)
        ASSERT_FALSE(contains(primitive, origin + end * (k + 0.5) / 40 * (1 - 1e-7) * ray)) << primitive.index();
      if (!found) continue;
      ++hits;
      EXPECT_NEAR(hit.normal.norm(), 1, 1e-12);
      EXPECT_LE(hit.normal.dot(ray), 0) << primitive.index();
      EXPECT_TRUE(contains(primitive, origin + hit.distance * ray - 1e-9 * hit.normal) || hit.normal.dot(ray) > -1e-3)
          << primitive.index() << " at " << (origin + hit.distance * ray).transpose();
      EXPECT_FALSE(contains(primitive, origin + hit.distance * ray + 1e-9 * hit.normal));
    }
    EXPECT_GT(hits, 300) << primitive.index();
  }
}

/// The normal is the gradient: a ray beside it meets the tangent plane to second order.
TEST(Intersect, normals_are_tangent_to_the_surface) {
  for (const Primitive& primitive : bounded_primitives()) {
    const Vec3 origin(1.9, -2.3, 1.4), ray = (Vec3(0.05, 0.02, 0.03) - origin).normalized();
    SurfaceHit middle;
    if (!intersect(primitive, origin, ray, 0, 1e9, middle)) continue;
    const Vec3 p = origin + middle.distance * ray;
    for (const Vec3& aside : {Vec3(1e-5, 0, 0), Vec3(0, 1e-5, 0)}) {
      SurfaceHit hit;
      ASSERT_TRUE(intersect(primitive, origin + aside, ray, 0, 1e9, hit));
      const Vec3 q = origin + aside + hit.distance * ray;
      EXPECT_LT(std::abs(middle.normal.dot(q - p)), 1e-9) << primitive.index();
    }
  }
}

TEST(Intersect, honours_its_range) {
  SurfaceHit hit;
  EXPECT_FALSE(intersect(Sphere{1}, {0, 0, 5}, {0, 0, -1}, 0, 3.9, hit));
  ASSERT_TRUE(intersect(Sphere{1}, {0, 0, 5}, {0, 0, -1}, 4.5, 1e9, hit));
  EXPECT_DOUBLE_EQ(hit.distance, 6);
  ASSERT_TRUE(intersect(Box{{1, 1, 1}}, {0, 0, 0}, {0, 1, 0}, 0, 1e9, hit));
  EXPECT_DOUBLE_EQ(hit.distance, 1);
  EXPECT_TRUE(hit.normal.isApprox(Vec3::UnitY()));
}

TEST(RayScene, equals_brute_force) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  std::vector<Solid> solids;
  const std::vector<Primitive> primitives = bounded_primitives();
  for (int i = 0; i < 200; ++i)
    solids.push_back(
        {primitives[static_cast<std::size_t>(i) % primitives.size()],
         {12 * vector(), Quat(normal(random), normal(random), normal(random), normal(random)).normalized()},
         i});
  solids.push_back({HalfSpace{Vec3::UnitZ()}, {{0, 0, -20}, Quat::Identity()}, 200});
  const RayScene scene(solids);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    // Single precision, as the hierarchy sees the ray.
    const Vec3 origin = (30 * vector().normalized()).cast<float>().cast<double>();
    const Vec3 direction = (8 * vector() - origin).normalized().cast<float>().cast<double>();
    double nearest = 1e9;
    int owner = -1;
    for (const Solid& solid : solids) {
      SurfaceHit hit;
      const Mat3 to_local = solid.pose.orientation.toRotationMatrix().transpose();
      if (!intersect(solid.primitive, to_local * (origin - solid.pose.position), to_local * direction, 0, nearest, hit))
        continue;
      nearest = hit.distance;
      owner = solid.owner;
    }
    RayHit hit;
    ASSERT_EQ(scene.nearest(origin, direction, 1e9, hit), owner >= 0);
    EXPECT_EQ(scene.blocked(origin, direction, 1e9), owner >= 0);
    if (owner < 0) continue;
    ++hits;
    EXPECT_EQ(hit.owner, owner);
    EXPECT_NEAR(hit.distance, nearest, 2e-5 * nearest);
  }
  EXPECT_GT(hits, 500);
}

Model ball_on_floor(double radius, double unit = 1) {
  return ModelBuilder()
      .material("grain", 1000)
      .law("grain", "grain", {})
      .floor("grain")
      .sphere("grain", radius * unit, {.position = Vec3(0, 0, radius) * unit})
      .build();
}

RenderOptions plain(int width, int height) {
  RenderOptions options;
  options.width = width;
  options.height = height;
  options.legend = options.scale_bar = false;
  return options;
}

bool is_white(const Image& image, int x, int y) {
  const std::uint8_t* p = &image.rgb[3 * static_cast<std::size_t>(y * image.width + x)];
  return p[0] > 150 && std::abs(p[0] - p[2]) < 25;
}

/// The sphere's diameter in pixels is its diameter over the size of a pixel.
TEST(Render, sphere_has_its_size_in_the_picture) {
  const Model model = ball_on_floor(0.5);
  Camera camera;
  camera.eye = {0, -10, 0.5};
  camera.target = {0, 0, 0.5};
  camera.view_height = 2;
  camera.orthographic = true;
  RenderOptions options = plain(400, 400);
  options.samples = 1;
  const Image image = render(model, model.initial, camera, options);
  int lowest = 400, highest = -1;
  for (int y = 0; y < 400; ++y)
    if (is_white(image, 190, y)) lowest = std::min(lowest, y), highest = std::max(highest, y);
  EXPECT_EQ(lowest, 100);
  EXPECT_GT(highest, 200);
}

TEST(Render, colours_tell_shapes_or_populations) {
  ModelBuilder builder;
  builder.material("grain", 1000).law("grain", "grain", {}).floor("grain");
  for (const char* population : {"bed", "bed", "pile"})
    builder.sphere("grain", 0.5, {.position = Vec3(0, 0, 0.5 + static_cast<double>(builder.size()))}).named(population).as_grain();
  const Model model = builder.build();
  const GrainColours shapes(model, false), populations(model, true);
  EXPECT_EQ(shapes.colour(1), shapes.colour(3));
  EXPECT_EQ(shapes.label(3), "sphere");
  EXPECT_EQ(populations.colour(1), populations.colour(2));
  EXPECT_NE(populations.colour(1), populations.colour(3));
  EXPECT_EQ(populations.label(1), "bed");
  EXPECT_EQ(populations.label(3), "pile");
  EXPECT_LT(populations.rank(2), populations.rank(3));
}

TEST(Render, same_bytes_at_any_thread_count_and_any_scale) {
  RenderOptions options = plain(160, 100);
  options.legend = options.scale_bar = true;
  const Model model = test::picture_heap({.grains = 300, .funnel = true});
  const Camera camera = frame_scene(model, model.initial);
  options.threads = 1;
  const Image one = render(model, model.initial, camera, options);
  options.threads = 3;
  EXPECT_EQ(one.rgb, render(model, model.initial, camera, options).rgb);

  options.scale_bar = false;
  const double factor = std::ldexp(1, -14);
  const Model large = ball_on_floor(0.5), small = ball_on_floor(0.5, factor);
  Camera near;
  near.eye = {1, -3, 2};
  Camera far = near;
  far.eye *= factor;
  far.view_height *= factor;
  EXPECT_EQ(render(large, large.initial, near, options).rgb, render(small, small.initial, far, options).rgb);
}

TEST(Render, shadow_lies_on_the_far_side_of_the_sun) {
  const Model model = ball_on_floor(0.5);
  Camera camera;
  camera.eye = {0, 0, 10};
  camera.up = Vec3::UnitY();
  camera.view_height = 5;
  camera.orthographic = true;
  const Image image = render(model, model.initial, camera, plain(250, 250));
  const auto brightness = [&](int x, int y) { return image.rgb[3 * static_cast<std::size_t>(y * 250 + x) + 1]; };
  // The sun stands to the left and below in this picture.
  EXPECT_LT(brightness(125 + 34, 125 - 20), 0.8 * brightness(125 - 34, 125 + 20));
}

TEST(Render, only_and_hide_leave_out) {
  const Model model = test::picture_heap({.grains = 140});
  const Camera camera = frame_scene(model, model.initial);
  RenderOptions options = plain(160, 100);
  const Image all = render(model, model.initial, camera, options);
  options.only = "ellipsoid";
  const Image green = render(model, model.initial, camera, options);
  EXPECT_NE(all.rgb, green.rgb);
  options.hide = {"base"};
  EXPECT_NE(green.rgb, render(model, model.initial, camera, options).rgb);
}

TEST(Render, a_tool_in_front_is_glass) {
  const Shape wall = test::shape_of("plate", Box{{1, 0.05, 1}});
  const auto scene = [&](double y) {
    return ModelBuilder()
        .material("grain", 1000)
        .law("grain", "grain", {})
        .wall("grain", wall, {{0, y, 1}, Quat::Identity()})
        .sphere("grain", 0.5, {.position = {0, 0, 0.5}})
        .build();
  };
  const auto middle_is_white = [&](double y) {
    const Model model = scene(y);
    Camera camera;
    camera.eye = {0, -10, 0.5};
    camera.target = {0, 0, 0.5};
    camera.view_height = 2;
    return is_white(render(model, model.initial, camera, plain(64, 64)), 29, 22);
  };
  EXPECT_TRUE(middle_is_white(2));
  EXPECT_TRUE(middle_is_white(-2));
}

TEST(Render, refuses_what_it_cannot_draw) {
  const Model model = ball_on_floor(0.5);
  const Camera camera = frame_scene(model, model.initial);
  EXPECT_THROW(render(model, Snapshot{}, camera), Error);
  EXPECT_THROW(render(model, model.initial, camera, plain(0, 100)), Error);
  EXPECT_THROW(render(model, model.initial, camera, plain(100, 1 << 20)), Error);
  RenderOptions options = plain(64, 64);
  options.samples = 0;
  EXPECT_THROW(render(model, model.initial, camera, options), Error);
  options.samples = 1;
  options.only = "twin";
  EXPECT_THROW(render(model, model.initial, camera, options), Error);
  Snapshot broken = model.initial;
  broken.position[1].x() = std::nan("");
  EXPECT_THROW(render(model, broken, camera, plain(64, 64)), Error);
  Camera blind = camera;
  blind.up = blind.target - blind.eye;
  EXPECT_THROW(render(model, model.initial, blind, plain(64, 64)), Error);
  blind = camera;
  blind.view_height = 0;
  EXPECT_THROW(render(model, model.initial, blind, plain(64, 64)), Error);
}

TEST(Camera, frame_holds_the_heap_whatever_flew_off) {
  Model model = test::picture_heap({.grains = 400});
  Snapshot state = model.initial;
  const std::size_t last = state.size() - 1;
  state.position[last] = {50, 20, 90};
  state.position[last - 1] = {0, 0, -700};
  for (const View view : {View::iso, View::side, View::top}) {
    FrameOptions options;
    options.view = view;
    const Camera camera = frame_scene(model, state, options);
    const Camera calm = frame_scene(model, model.initial, options);
    EXPECT_NEAR(camera.view_height / calm.view_height, 1, 0.03);
    const CameraAxes axes = camera_axes(camera);
    for (std::size_t i = 1; i + 2 < state.size(); ++i) {
      const Vec3 p = state.position[i] - camera.eye;
      const double depth = camera.orthographic ? 1 : axes.forward.dot(p) / (camera.target - camera.eye).norm();
      EXPECT_LT(std::abs(axes.up.dot(p) / depth), 0.5 * camera.view_height);
      EXPECT_LT(std::abs(axes.right.dot(p) / depth), 0.5 * options.aspect * camera.view_height);
    }
  }
  EXPECT_THROW(frame_scene(Model{}, Snapshot{}), Error);
  EXPECT_THROW(view_named("front"), Error);
}

TEST(Camera, side_view_keeps_angles) {
  const Model model = test::picture_heap({.grains = 200});
  FrameOptions options;
  options.view = View::side;
  const Camera camera = frame_scene(model, model.initial, options);
  EXPECT_TRUE(camera.orthographic);
  const CameraAxes axes = camera_axes(camera);
  EXPECT_TRUE(axes.up.isApprox(Vec3::UnitZ()));
  EXPECT_TRUE(axes.forward.isApprox(Vec3::UnitY()));
}

TEST(Annotate, round_lengths_and_labels) {
  EXPECT_DOUBLE_EQ(round_length(7.3e-4), 5e-4);
  EXPECT_DOUBLE_EQ(round_length(5e-4), 5e-4);
  EXPECT_DOUBLE_EQ(round_length(4.9e-4), 2e-4);
  EXPECT_DOUBLE_EQ(round_length(1), 1);
  EXPECT_EQ(length_label(5e-4), "500 µm");
  EXPECT_EQ(length_label(2e-3), "2 mm");
  EXPECT_EQ(length_label(0.1), "10 cm");
  EXPECT_EQ(length_label(5), "5 m");
  EXPECT_EQ(length_label(1e-6), "1 µm");
  EXPECT_EQ(grouped(12345678), "12,345,678");
  EXPECT_EQ(grouped(999), "999");
}

/// Machado et al. (2009), full deuteranopia: the seven colours stay apart.
TEST(Palette, shapes_are_told_apart_by_colour_blind_readers) {
  Mat3 deuteranopia;
  deuteranopia << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881;
  const auto& names = grain_shape_names();
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const auto seen = [&](const std::string& name) -> Vec3 {
        return (deuteranopia * shape_colour(name)).unaryExpr([](double c) { return srgb(c); });
      };
      EXPECT_GT((seen(names[i]) - seen(names[k])).norm(), 0.15) << names[i] << " " << names[k];
    }
}

TEST(Image, png_and_jpeg_have_their_signatures) {
  const Image image{3, 2, std::vector<std::uint8_t>(18, 200)};
  EXPECT_EQ(encode_png(image).substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(encode_jpeg(image).substr(0, 3), "\xff\xd8\xff");
  EXPECT_THROW(encode_png({3, 2, {}}), Error);
  EXPECT_THROW(encode_jpeg({0, 0, {}}), Error);
  const auto file = std::filesystem::temp_directory_path() / "repose_image_test.png";
  write_png(file, image);
  std::ifstream in(file, std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), encode_png(image));
  std::filesystem::remove(file);
  EXPECT_THROW(write_png("/nonexistent/folder/a.png", image), Error);
}

}  // namespace
}  // namespace repose
