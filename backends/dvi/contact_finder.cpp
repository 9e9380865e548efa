#include "backends/dvi/contact_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "backends/dvi/resize.hpp"
#include "backends/dvi/team.hpp"
#include "core/periodic_body.hpp"

namespace repose::dvi {

namespace {

constexpr std::size_t chunk_size = 256;  // bodies whose contacts are found by one thread at a time
constexpr double resting_share = 0.02;  // of the radius
constexpr double handed_on = 0.25;       // of the stir: how much of it a blow within the step may add to a pair

std::uint64_t name_of(std::int32_t a, std::int32_t b) {
  return static_cast<std::uint64_t>(std::min(a, b)) << 32 | static_cast<std::uint64_t>(std::max(a, b));
}

bool stands(std::span<const char> moved, std::int32_t body) { return !moved.empty() && moved[static_cast<std::size_t>(body)] == 0; }

/// Contacts found before, pair by pair, asked for in the same order of pairs.
class FoundBefore {
 public:
  explicit FoundBefore(std::span<const FoundContact> found) : found_(found) {}

  std::span<const FoundContact> next(std::uint64_t bodies) {
    const std::size_t first = at_;
    while (at_ < found_.size() && found_[at_].id.bodies == bodies) ++at_;
    return found_.subspan(first, at_ - first);
  }

 private:
  std::span<const FoundContact> found_;
  std::size_t at_ = 0;
};

}  // namespace

ContactFinder::ContactFinder(const Model& model, double unit)
    : model_(model), unit_(unit), cell_(model.periodic.in_unit(unit)), periodic_(model.periodic.any()) {
  const std::size_t n = model.bodies.size();
  if (periodic_) {
    endless_.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i)
      for (int k = 0; k < 2; ++k)
        if (is_endless(model, i, k)) endless_[i] = static_cast<std::uint8_t>(endless_[i] | 1u << k);
  }
  first_part_.push_back(0);
  for (std::size_t i = 0; i < n; ++i) {
    const Body& body = model.bodies[i];
    const Shape& shape = model.shapes[static_cast<std::size_t>(body.shape)];
    (body.dynamic ? dynamic_ : prescribed_).push_back(static_cast<std::int32_t>(i));
    const double scale = body.scale / unit;
    bound_.push_back(shape.bounding_radius * scale);
    resting_margin_.push_back(body.dynamic ? resting_share * body.radius / unit
                                           : std::numeric_limits<double>::infinity());
    const auto* sphere = shape.parts.size() == 1 ? std::get_if<Sphere>(&shape.parts[0].primitive) : nullptr;
    const bool centred = sphere != nullptr && shape.parts[0].pose.position.isZero(0);
    sphere_.push_back(centred ? sphere->radius * scale : 0.0);
    material_.push_back(body.material);
    gated_.push_back(!body.active.empty());
    for (const Part& part : shape.parts) {
      PlacedPart placed;
      placed.primitive.primitive = &part.primitive;
      placed.primitive.scale = scale;
      placed.bound = bounding_radius(part.primitive) * scale;
      parts_.push_back(placed);
    }
    first_part_.push_back(static_cast<std::int32_t>(parts_.size()));
  }
  const LiquidBridge* bridge = find_contact_effect<LiquidBridge>(model.contact_effects);
  for (const PairLaw& law : model.laws) {
    double range = law.cohesion > 0 ? law.cohesion_range / unit : 0.0;
    if (bridge != nullptr) range = std::max(range, bridge->rupture / unit);
    cohesion_range_.push_back(range);
    widest_cohesion_ = std::max(widest_cohesion_, range);
  }
  stir_.assign(n, 0.0);
}

void ContactFinder::place_parts(const BodyPlacement& placement, std::span<const char> moved, int threads) {
  const auto n = static_cast<std::ptrdiff_t>(model_.bodies.size());
  on_team(threads, [&] {
#pragma omp for schedule(static)
    for (std::ptrdiff_t i = 0; i < n; ++i) {
      const auto body = static_cast<std::size_t>(i);
      if (stands(moved, static_cast<std::int32_t>(i))) continue;
      const Body& b = model_.bodies[body];
      const Shape& shape = model_.shapes[static_cast<std::size_t>(b.shape)];
      const double scale = b.scale / unit_;
      for (std::size_t k = 0; k < shape.parts.size(); ++k) {
        PlacedPrimitive& placed = parts_[static_cast<std::size_t>(first_part_[body]) + k].primitive;
        const Pose& pose = shape.parts[k].pose;
        placed.position = placement.position[body];
        if (sphere_[body] > 0) continue;  // however it is turned
        placed.position += placement.rotation[body] * (scale * pose.position);
        placed.rotation = placement.rotation[body] * pose.orientation.toRotationMatrix();
      }
    }
  });
}

void ContactFinder::local_speeds(const BodyPlacement& placement, double step, int threads) {
  // Velocities met in each cell of a coarse grid and its 26 neighbours, as a box in velocity space.
  double widest = 0;
  for (std::int32_t i : dynamic_) widest = std::max(widest, bound_[static_cast<std::size_t>(i)]);
  const double wide = widest > 0 ? 1 / (4 * widest) : 1;
  Vec3 inverse = Vec3::Constant(wide);
  std::int64_t around[3] = {0, 0, 0};  // cells to a period; 0: not periodic
  for (int k = 0; k < 3; ++k) {
    if (!cell_.along(k)) continue;
    around[k] = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::min(1e6, cell_.length(k) * wide)));
    inverse[k] = static_cast<double>(around[k]) / cell_.length(k);
  }
  const auto wrapped = [&](std::int64_t at, int k) {
    if (around[k] == 0) return at;
    const std::int64_t left = at % around[k];
    return left < 0 ? left + around[k] : left;
  };
  const auto cell = [&](const Vec3& x, int k) {
    return wrapped(static_cast<std::int64_t>(std::floor(std::clamp((x[k] - cell_.lower[k]) * inverse[k], -1e6, 1e6))), k);
  };
  const auto key = [](std::int64_t x, std::int64_t y, std::int64_t z) {
    return (static_cast<std::uint64_t>(x + 1048576) << 42) ^ (static_cast<std::uint64_t>(y + 1048576) << 21) ^
           static_cast<std::uint64_t>(z + 1048576);
  };
  struct Cell {
    std::int64_t x = 0, y = 0, z = 0;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    double stir = 0;
    void meet(const Vec3& velocity) {
      low = low.cwiseMin(velocity);
      high = high.cwiseMax(velocity);
    }
  };
  std::vector<Cell> cells;
  std::vector<std::size_t> cell_of(dynamic_.size());
  // Of a few bodies the cells are looked through: 27 questions to a table cost more than all the rest of their step.
  constexpr std::size_t few = 8, none = ~std::size_t{0};
  const bool tabled = dynamic_.size() > few;
  std::unordered_map<std::uint64_t, std::size_t> index;
  if (tabled) index.reserve(dynamic_.size() / 4 + 16);
  const auto find = [&](std::int64_t cx, std::int64_t cy, std::int64_t cz) {
    if (tabled) {
      const auto at = index.find(key(cx, cy, cz));
      return at == index.end() ? none : at->second;
    }
    for (std::size_t k = 0; k < cells.size(); ++k)
      if (cells[k].x == cx && cells[k].y == cy && cells[k].z == cz) return k;
    return none;
  };
  for (std::size_t at = 0; at < dynamic_.size(); ++at) {
    const auto body = static_cast<std::size_t>(dynamic_[at]);
    const Vec3& x = placement.position[body];
    const std::int64_t cx = cell(x, 0), cy = cell(x, 1), cz = cell(x, 2);
    cell_of[at] = find(cx, cy, cz);
    if (cell_of[at] == none) {
      cell_of[at] = cells.size();
      cells.emplace_back();
      cells.back().x = cx;
      cells.back().y = cy;
      cells.back().z = cz;
      if (tabled) index.emplace(key(cx, cy, cz), cell_of[at]);
    }
    cells[cell_of[at]].meet(placement.velocity[body]);
  }
  for (const FoundContact& contact : tool_contacts_) {
    const auto a = static_cast<std::size_t>(contact.id.a()), b = static_cast<std::size_t>(contact.id.b());
    const std::size_t free_body = model_.bodies[a].dynamic ? a : b, tool = model_.bodies[a].dynamic ? b : a;
    const Vec3& x = placement.position[free_body];
    cells[find(cell(x, 0), cell(x, 1), cell(x, 2))].meet(placement.velocity[tool]);
  }
  for_each_index(threads, cells.size(), [&](std::size_t number) {
    Cell& c = cells[number];
    Cell all;
    for (std::int64_t dz = -1; dz <= 1; ++dz)
      for (std::int64_t dy = -1; dy <= 1; ++dy)
        for (std::int64_t dx = -1; dx <= 1; ++dx) {
          const std::size_t at = find(wrapped(c.x + dx, 0), wrapped(c.y + dy, 1), c.z + dz);
          if (at == none) continue;
          const Cell& near = cells[at];
          all.low = all.low.cwiseMin(near.low);
          all.high = all.high.cwiseMax(near.high);
        }
    c.stir = (all.high - all.low).norm();
  });
  for (std::size_t at = 0; at < dynamic_.size(); ++at)
    stir_[static_cast<std::size_t>(dynamic_[at])] = step * cells[cell_of[at]].stir;
}

double ContactFinder::cohesion_range(const Candidate& a, const Candidate& b) const {
  if (widest_cohesion_ == 0) return 0;
  return cohesion_range_[static_cast<std::size_t>(a.material) * model_.materials.size() + static_cast<std::size_t>(b.material)];
}

ContactFinder::Candidate ContactFinder::candidate(const BodyPlacement& placement, std::int32_t body) const {
  const auto i = static_cast<std::size_t>(body);
  Candidate c;
  c.position = placement.position[i];
  c.velocity = placement.velocity[i];
  c.angular_velocity = placement.angular_velocity[i];
  c.bound = bound_[i];
  c.turning_speed = placement.turning_speed[i];
  c.stir = stir_[i];
  c.resting_margin = resting_margin_[i];
  c.sphere = sphere_[i];
  c.body = body;
  c.material = material_[i];
  c.present = present_[i] != 0;
  c.gated = gated_[i] != 0;
  return c;
}

void ContactFinder::place_candidates(const BodyPlacement& placement, std::span<const char> moved, int threads) {
  candidate_.resize(order_.size());
  for_each_index(threads, order_.size(), [&](std::size_t rank) {
    if (!stands(moved, order_[rank])) candidate_[rank] = candidate(placement, order_[rank]);
  });
}

template <class Search>
void ContactFinder::each_chunk(std::vector<Chunk>& chunks, std::size_t count, int threads, Search&& search) {
  chunks.resize(count);
  const auto look = [&](std::size_t i, Scratch& scratch) __attribute__((noinline)) { search(chunks[i], i, scratch); };
  if (threads <= 1) {  // a shared loop allocates what its threads share, even for one
    Scratch scratch;
    for (std::size_t i = 0; i < count; ++i) look(i, scratch);
    return;
  }
  on_team(threads, [&] {
    Scratch scratch;
#pragma omp for schedule(dynamic)
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(count); ++i) look(static_cast<std::size_t>(i), scratch);
  });
}

void ContactFinder::gather(std::span<const FoundContact> first, const std::vector<Chunk>& chunks, int threads,
                           std::vector<FoundContact>& out) {
  std::vector<std::size_t> start{first.size()};
  for (const Chunk& chunk : chunks) start.push_back(start.back() + chunk.found.size());
  resize_sparingly(out, start.back());
  std::copy(first.begin(), first.end(), out.begin());
  for_each_index(threads, chunks.size(), [&](std::size_t k) {
    std::copy(chunks[k].found.begin(), chunks[k].found.end(), out.begin() + static_cast<std::ptrdiff_t>(start[k]));
  });
}

void ContactFinder::find_tool_contacts(const BodyPlacement& placement, double step, std::span<const char> moved, int threads) {
  std::vector<Candidate> tools;
  for (std::int32_t tool : prescribed_)
    if (present_[static_cast<std::size_t>(tool)]) tools.push_back(candidate(placement, tool));
  const bool tools_stand = std::all_of(tools.begin(), tools.end(), [&](const Candidate& tool) { return stands(moved, tool.body); });
  const std::size_t chunks = (dynamic_.size() + chunk_size - 1) / chunk_size;
  each_chunk(tool_chunk_, chunks, threads, [&](Chunk& chunk, std::size_t number, Scratch& scratch) {
    const std::size_t first = number * chunk_size, last = std::min(first + chunk_size, dynamic_.size());
    const auto body_stands = [&](std::int32_t body) { return stands(moved, body); };
    if (tools_stand && std::all_of(dynamic_.begin() + static_cast<std::ptrdiff_t>(first), dynamic_.begin() + static_cast<std::ptrdiff_t>(last), body_stands)) return;
    if (!moved.empty()) scratch.before.assign(chunk.found.begin(), chunk.found.end());
    FoundBefore before(scratch.before);
    chunk.found.clear();
    for (std::size_t at = first; at < last; ++at) {
      const Candidate body = candidate(placement, dynamic_[at]);
      if (!body.present) continue;
      for (const Candidate& tool : tools) {
        const auto kept = before.next(name_of(body.body, tool.body));
        if (stands(moved, body.body) && stands(moved, tool.body))
          chunk.found.insert(chunk.found.end(), kept.begin(), kept.end());
        else
          collide_bodies(body, tool, step, scratch.points, chunk.found);
      }
    }
  });
  gather({}, tool_chunk_, threads, tool_contacts_);
}

Vec3 ContactFinder::image_shift(std::span<const Vec3> position, std::int32_t a, std::int32_t b) const {
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  return shift_between(position[i], position[j], a, b);
}

Vec3 ContactFinder::shift_between(const Vec3& from, const Vec3& to, std::int32_t a, std::int32_t b) const {
  if (!periodic_) return Vec3::Zero();
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  Vec3 shift = cell_.to_nearest(to - from);
  if (shift.isZero(0)) return shift;
  for (int k = 0; k < 2; ++k)
    if ((endless_[i] | endless_[j]) >> k & 1) shift[k] = 0;
  return shift;
}

template <class Keep>
void ContactFinder::collide_parts(const Candidate& a, const Candidate& b, const Vec3& shift, double margin,
                                  std::vector<ContactPoint>& scratch, Keep&& keep) const {
  const auto i = static_cast<std::size_t>(a.body), j = static_cast<std::size_t>(b.body);
  for (std::int32_t p = first_part_[i]; p < first_part_[i + 1]; ++p)
    for (std::int32_t q = first_part_[j]; q < first_part_[j + 1]; ++q) {
      const PlacedPart& x = parts_[static_cast<std::size_t>(p)];
      const PlacedPart& y = parts_[static_cast<std::size_t>(q)];
      const double reach = x.bound + y.bound + margin;
      const Vec3 place = y.primitive.position + shift;
      if ((place - x.primitive.position).squaredNorm() > reach * reach) continue;
      scratch.clear();
      if (shift.isZero(0)) {
        collide(x.primitive, y.primitive, margin, scratch);
      } else {
        PlacedPrimitive image = y.primitive;
        image.position = place;
        collide(x.primitive, image, margin, scratch);
      }
      const std::uint64_t parts =
          static_cast<std::uint64_t>(p - first_part_[i]) << 48 | static_cast<std::uint64_t>(q - first_part_[j]) << 32;
      for (const ContactPoint& point : scratch) keep(point, parts);
    }
}

void ContactFinder::collide_bodies(const Candidate& x, const Candidate& y, double step, std::vector<ContactPoint>& scratch,
                                   std::vector<FoundContact>& out) const {
  const Candidate& a = x.body < y.body ? x : y;
  const Candidate& b = x.body < y.body ? y : x;
  const double slack =
      search_margin_ * (handed_on * std::max(a.stir, b.stir) + std::min(a.resting_margin, b.resting_margin));
  const double cohesion = cohesion_range(a, b);
  const double approach = (a.velocity - b.velocity).norm() + a.turning_speed + b.turning_speed;
  const double margin = std::max(step * approach + slack, search_margin_ * cohesion);
  const Vec3 shift = shift_between(a.position, b.position, a.body, b.body);
  const Vec3 place_b = b.position + shift, d = place_b - a.position;
  const double reach = a.bound + b.bound + margin, squared = d.squaredNorm();
  if (std::isfinite(reach) && squared > reach * reach) return;
  const auto keep = [&](const ContactPoint& point, std::uint64_t parts) {
    if (point.gap > cohesion) {
      const Vec3 u = b.velocity + b.angular_velocity.cross(point.point - place_b) - a.velocity -
                     a.angular_velocity.cross(point.point - a.position);
      if (!(point.gap + step * point.normal.dot(u) <= slack)) return;
    }
    for (const Candidate* body : {&a, &b})
      if (body->gated && point.gap < -model_.bodies[static_cast<std::size_t>(body->body)].gate_tolerance / unit_) return;
    out.push_back({{name_of(a.body, b.body), parts | point.feature}, point});
  };
  if (a.sphere > 0 && b.sphere > 0) {
    const double distance = std::sqrt(squared);
    ContactPoint point;
    point.normal = distance > 0 ? Vec3(d / distance) : Vec3::UnitZ();
    point.gap = distance - (a.sphere + b.sphere);
    point.point = a.position + (a.sphere + 0.5 * point.gap) * point.normal;
    if (point.gap <= margin) keep(point, 0);
  } else {
    collide_parts(a, b, shift, margin, scratch, keep);
  }
}

const std::vector<FoundContact>& ContactFinder::find(const BodyPlacement& placement, double step, double search_margin,
                                                     int threads) {
  search_margin_ = search_margin;
  present_.assign(placement.present.begin(), placement.present.end());
  place_parts(placement, {}, threads);
  std::fill(stir_.begin(), stir_.end(), 0.0);  // what tools touch must not depend on the step before
  find_tool_contacts(placement, step, {}, threads);
  local_speeds(placement, step, threads);

  centre_.resize(dynamic_.size());
  reach_.resize(dynamic_.size());
  for_each_index(threads, dynamic_.size(), [&](std::size_t at) {
    const auto body = static_cast<std::size_t>(dynamic_[at]);
    centre_[at] = placement.position[body];
    // The stir bounds the difference of any two velocities nearby, so this covers the reach of every pair.
    reach_[at] = bound_[body] +
                 search_margin * std::max(step * placement.turning_speed[body] + stir_[body] + resting_margin_[body], widest_cohesion_);
  });
  broad_.build(centre_, reach_, cell_, threads);
  order_.clear();
  for (std::int32_t i : broad_.order()) order_.push_back(dynamic_[static_cast<std::size_t>(i)]);

  place_candidates(placement, {}, threads);
  const std::size_t chunks = (order_.size() + chunk_size - 1) / chunk_size;
  each_chunk(chunk_, chunks, threads, [&](Chunk& chunk, std::size_t number, Scratch& scratch) {
    chunk.near.clear();
    chunk.found.clear();
    const std::size_t first = number * chunk_size;
    for (std::size_t rank = first; rank < std::min(first + chunk_size, order_.size()); ++rank) {
      const Candidate& a = candidate_[rank];
      if (!a.present) continue;
      broad_.partners(rank, [&](std::size_t other) {
        const Candidate& b = candidate_[other];
        if (!b.present) return;
        collide_bodies(a, b, step, scratch.points, chunk.found);
        // A pair that falls side by side may meet all the same, by a blow that is handed on within the step.
        chunk.near.push_back({static_cast<std::int32_t>(rank), static_cast<std::int32_t>(other)});
      });
    }
  });
  gather(tool_contacts_, chunk_, threads, found_);
  return found_;
}

const std::vector<FoundContact>& ContactFinder::find_again(const BodyPlacement& placement, std::span<const char> moved, int threads) {
  place_parts(placement, moved, threads);
  std::fill(stir_.begin(), stir_.end(), 0.0);
  find_tool_contacts(placement, 0, moved, threads);
  place_candidates(placement, moved, threads);
  const auto rank_stands = [&](std::int32_t rank) { return stands(moved, order_[static_cast<std::size_t>(rank)]); };
  const auto pair_stands = [&](const auto& pair) { return rank_stands(pair.first) && rank_stands(pair.second); };
  each_chunk(chunk_, chunk_.size(), threads, [&](Chunk& chunk, std::size_t, Scratch& scratch) {
    if (std::all_of(chunk.near.begin(), chunk.near.end(), pair_stands)) return;
    if (!moved.empty()) scratch.before.assign(chunk.found.begin(), chunk.found.end());
    FoundBefore before(scratch.before);
    chunk.found.clear();
    for (const auto& pair : chunk.near) {
      const Candidate& a = candidate_[static_cast<std::size_t>(pair.first)];
      const Candidate& b = candidate_[static_cast<std::size_t>(pair.second)];
      const auto kept = before.next(name_of(a.body, b.body));
      if (pair_stands(pair))
        chunk.found.insert(chunk.found.end(), kept.begin(), kept.end());
      else
        collide_bodies(a, b, 0, scratch.points, chunk.found);
    }
  });
  gather(tool_contacts_, chunk_, threads, found_);
  return found_;
}

}  // namespace repose::dvi
