#include "analysis/render/ray_scene.hpp"

#include <embree3/rtcore.h>

#include <cassert>
#include <cmath>
#include <limits>

#include "analysis/render/intersect.hpp"
#include "core/error.hpp"

namespace repose {
namespace {

struct Placed {
  Primitive primitive;
  Mat3 to_local;
  Vec3 position;
  int owner;
  Vec3 lower, upper;  ///< bounds in the world
};

/// The box around the primitive's own box, turned: not the tightest, but right for every primitive.
void bound(Placed& placed) {
  Vec3 centre = Vec3::Zero(), half = Vec3::Zero();
  std::visit(
      [&](const auto& p) {
        using T = std::decay_t<decltype(p)>;
        if constexpr (std::is_same_v<T, Sphere>) {
          half.setConstant(p.radius);
        } else if constexpr (std::is_same_v<T, Ellipsoid>) {
          half = p.semi_axes;
        } else if constexpr (std::is_same_v<T, RoundCone>) {
          const double r = std::max(p.radius_a, p.radius_b);
          const double left = std::min(-p.radius_a, p.length - p.radius_b),
                       right = std::max(p.radius_a, p.length + p.radius_b);
          centre.x() = 0.5 * (left + right);
          half = {0.5 * (right - left), r, r};
        } else if constexpr (std::is_same_v<T, Cone>) {
          centre.z() = 0.5 * p.height;
          half = {p.radius, p.radius, 0.5 * p.height};
        } else if constexpr (std::is_same_v<T, Box>) {
          half = p.half_extents;
        } else if constexpr (std::is_same_v<T, Cylinder>) {
          half = {p.radius, p.radius, p.half_height};
        } else if constexpr (std::is_same_v<T, Revolved>) {
          double bottom = std::numeric_limits<double>::infinity(), top = -bottom, r = 0;
          for (const Vec2& q : p.profile) {
            r = std::max(r, q.x());
            bottom = std::min(bottom, q.y());
            top = std::max(top, q.y());
          }
          centre.z() = 0.5 * (bottom + top);
          half = {r, r, 0.5 * (top - bottom)};
        } else if constexpr (std::is_same_v<T, TriMesh>) {
          Vec3 lower = Vec3::Constant(std::numeric_limits<double>::infinity()), upper = -lower;
          for (const Vec3& v : p.vertices) {
            lower = lower.cwiseMin(v);
            upper = upper.cwiseMax(v);
          }
          centre = 0.5 * (lower + upper);
          half = 0.5 * (upper - lower);
        }
      },
      placed.primitive);
  const Vec3 c = placed.position + placed.to_local.transpose() * centre;
  Vec3 h = placed.to_local.transpose().cwiseAbs() * half;
  if (const auto* e = std::get_if<Ellipsoid>(&placed.primitive))
    h = (placed.to_local.transpose() * e->semi_axes.asDiagonal()).rowwise().norm();
  // Single-precision boxes must hold the double-precision solid.
  h += Vec3::Constant(1e-6 * (h.maxCoeff() + c.cwiseAbs().maxCoeff()));
  placed.lower = c - h;
  placed.upper = c + h;
}

bool hit_placed(const Placed& placed, const RTCRay& ray, SurfaceHit& hit) {
  const Vec3 origin = placed.to_local * (Vec3(ray.org_x, ray.org_y, ray.org_z) - placed.position);
  const Vec3 direction = placed.to_local * Vec3(ray.dir_x, ray.dir_y, ray.dir_z);
  return intersect(placed.primitive, origin, direction, ray.tnear, ray.tfar, hit);
}

RTCRay make_ray(const Vec3& origin, const Vec3& direction, double t_max) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x());
  ray.org_y = static_cast<float>(origin.y());
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tnear = 0;
  ray.tfar = static_cast<float>(std::min(t_max, 1e30));
  ray.mask = ~0U;
  return ray;
}

}  // namespace

struct RayScene::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<Placed> bounded, unbounded;
  std::vector<int> mesh_owner;  ///< by geometry number; -1 for the user geometry

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  void add_mesh(const TriMesh& mesh, const Pose& pose, int owner);
  void add_bounded();

  static void bounds(const RTCBoundsFunctionArguments* args);
  static void intersect_one(const RTCIntersectFunctionNArguments* args);
  static void occlude_one(const RTCOccludedFunctionNArguments* args);
};

void RayScene::Impl::bounds(const RTCBoundsFunctionArguments* args) {
  const Placed& placed = static_cast<const Impl*>(args->geometryUserPtr)->bounded[args->primID];
  RTCBounds& box = *args->bounds_o;
  box.lower_x = static_cast<float>(placed.lower.x());
  box.lower_y = static_cast<float>(placed.lower.y());
  box.lower_z = static_cast<float>(placed.lower.z());
  box.upper_x = static_cast<float>(placed.upper.x());
  box.upper_y = static_cast<float>(placed.upper.y());
  box.upper_z = static_cast<float>(placed.upper.z());
}

void RayScene::Impl::intersect_one(const RTCIntersectFunctionNArguments* args) {
  assert(args->N == 1);
  if (!args->valid[0]) return;
  auto& query = *reinterpret_cast<RTCRayHit*>(args->rayhit);
  const Placed& placed = static_cast<const Impl*>(args->geometryUserPtr)->bounded[args->primID];
  SurfaceHit found;
  if (!hit_placed(placed, query.ray, found)) return;
  const Vec3 normal = placed.to_local.transpose() * found.normal;
  query.ray.tfar = static_cast<float>(found.distance);
  query.hit.Ng_x = static_cast<float>(normal.x());
  query.hit.Ng_y = static_cast<float>(normal.y());
  query.hit.Ng_z = static_cast<float>(normal.z());
  query.hit.primID = args->primID;
  query.hit.geomID = args->geomID;
}

void RayScene::Impl::occlude_one(const RTCOccludedFunctionNArguments* args) {
  assert(args->N == 1);
  if (!args->valid[0]) return;
  auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
  SurfaceHit found;
  if (hit_placed(static_cast<const Impl*>(args->geometryUserPtr)->bounded[args->primID], ray, found))
    ray.tfar = -std::numeric_limits<float>::infinity();
}

void RayScene::Impl::add_bounded() {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(bounded.size()));
  rtcSetGeometryUserData(geometry, this);
  rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect_one);
  rtcSetGeometryOccludedFunction(geometry, occlude_one);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, 0);
  rtcReleaseGeometry(geometry);
}

void RayScene::Impl::add_mesh(const TriMesh& mesh, const Pose& pose, int owner) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertices.size()));
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 3 * sizeof(unsigned), mesh.triangles.size()));
  for (const Vec3& vertex : mesh.vertices) {
    const Vec3 world = pose.to_world(vertex);
    for (int i = 0; i < 3; ++i) *vertices++ = static_cast<float>(world[i]);
  }
  for (const auto& triangle : mesh.triangles)
    for (const int index : triangle) *indices++ = static_cast<unsigned>(index);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, static_cast<unsigned>(mesh_owner.size()));
  rtcReleaseGeometry(geometry);
  mesh_owner.push_back(owner);
}

RayScene::RayScene(std::vector<Solid> solids) : impl_(std::make_unique<Impl>()) {
  // One builder thread: the hierarchy, and with it the answer to ties, is the same on every machine and in every run.
  impl_->device = rtcNewDevice("threads=1");
  if (!impl_->device)
    throw Error("picture", "Embree could not be started", "check that libembree3 fits this processor");
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  impl_->mesh_owner.push_back(-1);
  for (Solid& solid : solids) {
    if (const auto* mesh = std::get_if<TriMesh>(&solid.primitive)) {
      impl_->add_mesh(*mesh, solid.pose, solid.owner);
      continue;
    }
    const bool infinite = std::holds_alternative<HalfSpace>(solid.primitive);
    Placed placed{std::move(solid.primitive),
                  solid.pose.orientation.toRotationMatrix().transpose(),
                  solid.pose.position,
                  solid.owner,
                  Vec3::Zero(),
                  Vec3::Zero()};
    if (infinite) {
      impl_->unbounded.push_back(std::move(placed));
    } else {
      bound(placed);
      impl_->bounded.push_back(std::move(placed));
    }
  }
  if (!impl_->bounded.empty()) impl_->add_bounded();
  rtcCommitScene(impl_->scene);
  if (rtcGetDeviceError(impl_->device) != RTC_ERROR_NONE)
    throw Error("picture", "Embree could not build its hierarchy", "draw fewer bodies, or free some memory");
}

RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

bool RayScene::empty() const {
  return impl_->bounded.empty() && impl_->unbounded.empty() && impl_->mesh_owner.size() == 1;
}

bool RayScene::nearest(const Vec3& origin, const Vec3& direction, double t_max, RayHit& hit) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray = make_ray(origin, direction, t_max);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene, &context, &query);
  bool found = false;
  if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
    hit.distance = query.ray.tfar;
    hit.normal = Vec3(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized();
    hit.owner = query.hit.geomID == 0 ? impl_->bounded[query.hit.primID].owner : impl_->mesh_owner[query.hit.geomID];
    found = true;
  }
  for (const Placed& placed : impl_->unbounded) {
    SurfaceHit surface;
    if (!hit_placed(placed, query.ray, surface)) continue;
    query.ray.tfar = static_cast<float>(surface.distance);
    hit = {surface.distance, placed.to_local.transpose() * surface.normal, placed.owner};
    found = true;
  }
  return found;
}

bool RayScene::blocked(const Vec3& origin, const Vec3& direction, double t_max) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = make_ray(origin, direction, t_max);
  for (const Placed& placed : impl_->unbounded) {
    SurfaceHit surface;
    if (hit_placed(placed, ray, surface)) return true;
  }
  rtcOccluded1(impl_->scene, &context, &ray);
  return ray.tfar < 0;
}

}  // namespace repose
