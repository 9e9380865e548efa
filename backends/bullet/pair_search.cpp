#include "backends/bullet/pair_search.hpp"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>

#include <algorithm>

#include "backends/bullet/bullet_math.hpp"

namespace repose::bullet {

namespace {

constexpr int moving_group = 1, fixed_group = 2;

}  // namespace

struct PairSearch::Trees {
  btDbvtBroadphase broad;
  std::vector<btBroadphaseProxy*> proxy;  // owned by `broad`
  std::vector<std::int32_t> body;         // what the proxies point to
};

PairSearch::PairSearch(const std::vector<char>& fixed) : trees_(std::make_unique<Trees>()) {
  const std::size_t n = fixed.size();
  trees_->body.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    trees_->body[i] = static_cast<std::int32_t>(i);
    // Placed by set_box(); until then far from each other.
    const btVector3 at(1e6 + 10 * static_cast<double>(i), 0, 0);
    trees_->proxy.push_back(trees_->broad.createProxy(at, at, 0, &trees_->body[i], fixed[i] ? fixed_group : moving_group,
                                                      fixed[i] ? moving_group : moving_group | fixed_group, nullptr));
  }
}

PairSearch::~PairSearch() {
  for (btBroadphaseProxy* proxy : trees_->proxy) trees_->broad.destroyProxy(proxy, nullptr);
}

void PairSearch::set_box(std::int32_t body, const Vec3& low, const Vec3& high) {
  trees_->broad.setAabb(trees_->proxy[static_cast<std::size_t>(body)], to_bullet<btVector3>(low), to_bullet<btVector3>(high),
                        nullptr);
}

const std::vector<std::pair<std::int32_t, std::int32_t>>& PairSearch::pairs() {
  trees_->broad.calculateOverlappingPairs(nullptr);
  btBroadphasePairArray& found = trees_->broad.getOverlappingPairCache()->getOverlappingPairArray();
  pairs_.clear();
  for (int i = 0; i < found.size(); ++i) {
    const auto a = *static_cast<const std::int32_t*>(found[i].m_pProxy0->m_clientObject);
    const auto b = *static_cast<const std::int32_t*>(found[i].m_pProxy1->m_clientObject);
    pairs_.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(pairs_.begin(), pairs_.end());
  return pairs_;
}

}  // namespace repose::bullet
