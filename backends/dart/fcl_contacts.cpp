#include "backends/dart/fcl_contacts.hpp"

#include <algorithm>
#include <limits>
#include <unordered_map>

#include <dart/collision/CollisionFilter.hpp>
#include <dart/collision/CollisionGroup.hpp>
#include <dart/collision/CollisionObject.hpp>
#include <dart/collision/fcl/FCLCollisionDetector.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/EllipsoidShape.hpp>
#include <dart/dynamics/PlaneShape.hpp>
#include <dart/dynamics/SimpleFrame.hpp>
#include <dart/dynamics/SphereShape.hpp>

#include "core/overloaded.hpp"

namespace repose::dart {

namespace {

namespace engine = ::dart;

enum class Kind { none, sphere, ellipsoid, box, half_space };

Kind kind_of(const Primitive& primitive) {
  if (std::holds_alternative<Sphere>(primitive)) return Kind::sphere;
  if (std::holds_alternative<Ellipsoid>(primitive)) return Kind::ellipsoid;
  if (std::holds_alternative<Box>(primitive)) return Kind::box;
  if (std::holds_alternative<HalfSpace>(primitive)) return Kind::half_space;
  return Kind::none;
}

/// FCL's own primitives instead of meshes that resemble them. The setter for this prints a warning.
class PrimitiveDetector final : public engine::collision::FCLCollisionDetector {
 public:
  PrimitiveDetector() { mPrimitiveShapeType = PRIMITIVE; }
};

bool found_by_fcl(Kind a, Kind b) {
  if (a > b) std::swap(a, b);
  switch (a) {
    case Kind::sphere:
      return b != Kind::ellipsoid;
    case Kind::ellipsoid:
      return b == Kind::half_space;
    case Kind::box:
      return b == Kind::box;
    default:
      return false;
  }
}

/// With its skin; null if FCL has nothing of use.
engine::dynamics::ShapePtr shape_of(const Primitive& primitive, double scale) {
  const auto none = [](const auto&) { return engine::dynamics::ShapePtr(); };
  const auto thick = [scale](const Vec3& half) -> Vec3 { return 2 * (scale * half + Vec3::Constant(skin)); };
  return std::visit(
      Overloaded{[&](const Sphere& s) -> engine::dynamics::ShapePtr {
                   return std::make_shared<engine::dynamics::SphereShape>(scale * s.radius + skin);
                 },
                 [&](const Ellipsoid& e) -> engine::dynamics::ShapePtr {
                   return std::make_shared<engine::dynamics::EllipsoidShape>(thick(e.semi_axes));  // diameters
                 },
                 [&](const Box& b) -> engine::dynamics::ShapePtr {
                   return std::make_shared<engine::dynamics::BoxShape>(thick(b.half_extents));
                 },
                 [&](const HalfSpace& h) -> engine::dynamics::ShapePtr {
                   return std::make_shared<engine::dynamics::PlaneShape>(h.normal, skin);
                 },
                 none},
      primitive);
}

struct PartData {
  Kind kind = Kind::none;
  int body = -1;
  bool movable = false, present = true;
  std::shared_ptr<engine::dynamics::SimpleFrame> frame;      ///< null if FCL has nothing of use
  std::unique_ptr<engine::collision::CollisionGroup> alone;  ///< a group of this part
};

bool may_touch(const PartData& a, const PartData& b) {
  return a.body != b.body && (a.movable || b.movable) && a.present && b.present && found_by_fcl(a.kind, b.kind);
}

using Pair = std::pair<int, int>;

/// Notes the pairs whose boxes overlap, and has none of them looked at: which of a pair comes first is a matter of the
/// tree's past, and so would be the last digits.
class PairsNoted final : public engine::collision::CollisionFilter {
 public:
  bool ignoresCollision(const engine::collision::CollisionObject* first,
                        const engine::collision::CollisionObject* second) const override {
    const int a = index.at(first->getShapeFrame()), b = index.at(second->getShapeFrame());
    pairs.emplace_back(std::min(a, b), std::max(a, b));
    return true;
  }

  std::unordered_map<const engine::dynamics::ShapeFrame*, int> index;
  mutable std::vector<Pair> pairs;
};

}  // namespace

bool fcl_finds(const Primitive& a, const Primitive& b) { return found_by_fcl(kind_of(a), kind_of(b)); }

struct FclContacts::Engine {
  std::vector<PartData> parts;
  std::shared_ptr<PrimitiveDetector> detector = std::make_shared<PrimitiveDetector>();
  /// FCL's tree sorts the middles of boxes, and those of infinite ones are not numbers: half-spaces stay outside.
  std::unique_ptr<engine::collision::CollisionGroup> bounded = detector->createCollisionGroup();
  std::vector<int> half_spaces, others;
  std::shared_ptr<PairsNoted> noted = std::make_shared<PairsNoted>();
  engine::collision::CollisionOption note{true, 1, noted};
  engine::collision::CollisionOption look{true, std::numeric_limits<int>::max(), nullptr};
  engine::collision::CollisionResult result;

  void collide(const Pair& pair, std::vector<FclContact>& found);
};

void FclContacts::Engine::collide(const Pair& pair, std::vector<FclContact>& found) {
  const PartData &a = parts[static_cast<std::size_t>(pair.first)], &b = parts[static_cast<std::size_t>(pair.second)];
  if (!may_touch(a, b) || !a.alone->collide(b.alone.get(), look, &result)) return;
  for (const engine::collision::Contact& contact : result.getContacts()) {
    FclContact c;
    c.a = pair.first;
    c.b = pair.second;
    c.point = contact.point;
    c.normal = contact.normal.normalized();  // DART's points from the second to the first
    if (contact.collisionObject1->getShapeFrame() == a.frame.get()) c.normal = -c.normal;
    c.gap = 2 * skin - std::max(contact.penetrationDepth, 0.0);
    found.push_back(c);
  }
}

FclContacts::FclContacts() : engine_(std::make_unique<Engine>()) {}

FclContacts::~FclContacts() = default;

void FclContacts::add(const Primitive& primitive, double scale, int body, bool movable) {
  PartData part;
  part.kind = kind_of(primitive);
  part.body = body;
  part.movable = movable;
  if (const auto shape = shape_of(primitive, scale)) {
    const int number = static_cast<int>(engine_->parts.size());
    part.frame = engine::dynamics::SimpleFrame::createShared(engine::dynamics::Frame::World());
    part.frame->setShape(shape);
    part.alone = engine_->detector->createCollisionGroup();
    part.alone->addShapeFrame(part.frame.get());
    engine_->noted->index[part.frame.get()] = number;
    (part.kind == Kind::half_space ? engine_->half_spaces : engine_->others).push_back(number);
    if (part.kind != Kind::half_space) engine_->bounded->addShapeFrame(part.frame.get());
  }
  engine_->parts.push_back(std::move(part));
}

void FclContacts::place(int part, const Vec3& position, const Mat3& rotation, bool present) {
  PartData& data = engine_->parts[static_cast<std::size_t>(part)];
  data.present = present;
  if (!data.frame) return;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation;
  pose.translation() = position;
  data.frame->setRelativeTransform(pose);
}

const std::vector<FclContact>& FclContacts::find() {
  std::vector<Pair>& pairs = engine_->noted->pairs;
  pairs.clear();
  engine_->bounded->collide(engine_->note, &engine_->result);
  for (const int plane : engine_->half_spaces)
    for (const int other : engine_->others) pairs.emplace_back(std::min(plane, other), std::max(plane, other));
  std::sort(pairs.begin(), pairs.end());
  found_.clear();
  for (const Pair& pair : pairs) engine_->collide(pair, found_);
  return found_;
}

}  // namespace repose::dart
