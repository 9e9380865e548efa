#include "backends/dvi/narrow_phase.hpp"

#include <cassert>
#include <type_traits>

#include "backends/dvi/collide_box.hpp"
#include "backends/dvi/collide_convex.hpp"
#include "backends/dvi/collide_ellipsoid.hpp"
#include "backends/dvi/collide_mesh.hpp"
#include "backends/dvi/collide_plane.hpp"
#include "backends/dvi/collide_revolved.hpp"
#include "backends/dvi/collide_round_cone.hpp"
#include "backends/dvi/collide_solid_revolved.hpp"

namespace repose::dvi {

namespace {

/// The order of bodies in a pair: the one that comes first is handled as the first.
template <class T>
constexpr int rank() {
  if constexpr (std::is_same_v<T, Sphere>) return 0;
  if constexpr (std::is_same_v<T, Ellipsoid>) return 1;
  if constexpr (std::is_same_v<T, RoundCone>) return 2;
  if constexpr (std::is_same_v<T, Box>) return 3;
  if constexpr (std::is_same_v<T, Cylinder>) return 4;
  if constexpr (std::is_same_v<T, Cone>) return 5;
  if constexpr (std::is_same_v<T, TriMesh>) return 6;
  if constexpr (std::is_same_v<T, HalfSpace>) return 7;
  if constexpr (std::is_same_v<T, Revolved>) return 8;
}

template <class T>
constexpr bool is_round = rank<T>() <= 2;
template <class T>
constexpr bool is_lathe = std::is_same_v<T, Cylinder> || std::is_same_v<T, Cone>;

template <class T>
ConvexBody convex_body(const T& shape, const PlacedPrimitive& placed) {
  if constexpr (is_lathe<T>)
    return convex(shape, placed);
  else
    return convex(place(shape, placed));
}

bool collide_profile(const PlacedSphere& a, const PlacedProfile& b, const ContactSink& sink) {
  collide_sphere_profile(a, b, sink);
  return true;
}
bool collide_profile(const PlacedEllipsoid& a, const PlacedProfile& b, const ContactSink& sink) {
  return collide_ellipsoid_profile(a, b, sink);
}
bool collide_profile(const PlacedRoundCone& a, const PlacedProfile& b, const ContactSink& sink) {
  return collide_round_cone_profile(a, b, sink);
}

/// Two round grains.
template <class A, class B>
void collide_round(const A& a, const B& b, const ContactSink& sink) {
  if constexpr (std::is_same_v<A, PlacedSphere>) {
    if constexpr (std::is_same_v<B, PlacedSphere>) {
      const Vec3 d = b.centre - a.centre;
      const double radii = a.radius + b.radius, reach = radii + sink.margin, d2 = d.squaredNorm();
      if (d2 > reach * reach) return;
      const double distance = std::sqrt(d2);
      const Vec3 n = distance > 0 ? Vec3(d / distance) : Vec3(Vec3::UnitZ());
      const double gap = distance - radii;
      sink.add(a.centre + (a.radius + 0.5 * gap) * n, n, gap, 0);
    } else if constexpr (std::is_same_v<B, PlacedEllipsoid>) {
      collide_sphere_ellipsoid(a, b, sink);
    } else {
      collide_sphere_round_cone(a, b, sink);
    }
  } else if constexpr (std::is_same_v<A, PlacedEllipsoid>) {
    if constexpr (std::is_same_v<B, PlacedEllipsoid>)
      collide_ellipsoids(a, b, sink);
    else if (!collide_ellipsoid_round_cone(a, b, sink))
      collide_convex(convex(a), convex(b), sink);
  } else {
    collide_round_cones(a, b, sink);
  }
}

/// rank<A>() <= rank<B>().
template <class A, class B>
void collide_pair(const A& a, const PlacedPrimitive& pa, const B& b, const PlacedPrimitive& pb,
                  const ContactSink& sink) {
  if constexpr (rank<A>() >= 7) {
    assert(false && "half-spaces and revolved tools never meet each other");
  } else if constexpr (std::is_same_v<B, HalfSpace>) {
    collide_plane(a, pa, place(b, pb), sink);
  } else if constexpr (std::is_same_v<B, Revolved>) {
    const PlacedProfile solid{Profile(b.profile), pb.position, pb.rotation, pb.scale, false};
    if constexpr (is_round<A>)
      collide_profile(place(a, pa), solid, sink);
    else
      collide_solid_profile(a, pa, solid, sink);
  } else if constexpr (std::is_same_v<B, TriMesh>) {
    const PlacedMesh mesh{b, pb.position, pb.rotation, pb.scale};
    if constexpr (std::is_same_v<A, Sphere>)
      collide_sphere_mesh(place(a, pa), mesh, sink);
    else if constexpr (std::is_same_v<A, TriMesh>)
      collide_meshes({a, pa.position, pa.rotation, pa.scale}, mesh, sink);
    else
      collide_convex_mesh(convex_body(a, pa), mesh, sink);
  } else if constexpr (is_round<B>) {
    collide_round(place(a, pa), place(b, pb), sink);
  } else {
    bool done = false;
    if constexpr (is_round<A> && is_lathe<B>) {
      const auto points = profile_of(b, pb.scale);
      done = collide_profile(place(a, pa), {Profile(points), pb.position, pb.rotation, 1, true}, sink);
    } else if constexpr (std::is_same_v<A, Sphere>) {
      collide_sphere_box(place(a, pa), place(b, pb), sink);
      done = true;
    } else if constexpr (std::is_same_v<A, Ellipsoid>) {
      done = collide_ellipsoid_box(place(a, pa), place(b, pb), sink);
    } else if constexpr (std::is_same_v<A, RoundCone>) {
      done = collide_round_cone_box(place(a, pa), place(b, pb), sink);
    }
    if (!done) collide_convex(convex_body(a, pa), convex_body(b, pb), sink);
  }
}

/// Several routines may have served one pair: a feature number that is taken gets the next free one.
void make_features_unique(std::vector<ContactPoint>& out, std::size_t first) {
  for (std::size_t k = first + 1; k < out.size(); ++k)
    for (std::size_t other = first; other < k;) {
      if (out[other].feature == out[k].feature) {
        ++out[k].feature;
        other = first;
      } else {
        ++other;
      }
    }
}

}  // namespace

void collide(const PlacedPrimitive& a, const PlacedPrimitive& b, double margin, std::vector<ContactPoint>& out) {
  assert(a.primitive != nullptr && b.primitive != nullptr && margin >= 0);
  const std::size_t first = out.size();
  std::visit(
      [&](const auto& pa, const auto& pb) {
        using A = std::decay_t<decltype(pa)>;
        using B = std::decay_t<decltype(pb)>;
        if constexpr (rank<A>() <= rank<B>())
          collide_pair(pa, a, pb, b, {&out, margin, false});
        else
          collide_pair(pb, b, pa, a, {&out, margin, true});
      },
      *a.primitive, *b.primitive);
  if (out.size() > first + 1) make_features_unique(out, first);
}

}  // namespace repose::dvi
