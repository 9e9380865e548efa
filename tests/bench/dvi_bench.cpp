/// What the cone solvers cost: time per contact and iteration beside the bandwidth of the memory, bytes per contact, and
/// iterations and time to a given residual. Prints Markdown tables. `dvi_bench [--quick]`.
///
/// A bed of 58 um spheres is poured once (2,000 grains on a plate with periodic sides, by the backend itself) and laid out in rows of
/// tiles to the size wanted. A contact across a side joins a tile to the next: one connected bed of the same depth, whatever its size.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <unordered_map>

#include "backends/dvi/cone_solver.hpp"
#include "backends/dvi/contact_finder.hpp"
#include "backends/dvi/gauss_seidel.hpp"
#include "backends/dvi/packed_problem.hpp"
#include "backends/dvi/residual.hpp"
#include "backends/dvi/units.hpp"
#include "backends/dvi/world_dvi.hpp"
#include "core/run.hpp"
#include "tests/support/model_builder.hpp"

namespace repose::dvi {
namespace {

constexpr double radius = 29e-6;    // [m]
constexpr double step = 1e-4;       // [s]
constexpr int tile_grains = 2000;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  return x[x.size() / 2];
}

/// Bytes per second of a triad a = b + s c over arrays that no cache holds (three streams, 24 bytes an element).
double memory_bandwidth(int threads) {
  const std::size_t n = 16'000'000;
  std::vector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
  std::vector<double> rate;
  for (int run = 0; run < 5; ++run) {
    const double start = seconds_now();
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(n); ++i) {
      const auto k = static_cast<std::size_t>(i);
      a[k] = b[k] + 0.5 * c[k];
    }
    rate.push_back(24.0 * static_cast<double>(n) / (seconds_now() - start));
  }
  return median(rate);
}

Model bed(double rolling) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> shift(-0.1, 0.1), size(0.75, 1.0);
  PairLaw law;
  law.friction = 0.52;
  law.rolling_friction = law.spinning_friction = rolling;
  const int side = 9;
  const double half_width = 1.15 * side * radius;
  test::ModelBuilder builder;
  builder.material("grain", 1020).law("grain", "grain", law).floor("grain");
  for (const int axis : {0, 1}) builder.periodic(axis, -half_width, half_width);
  const Shape ball = test::shape_of("sphere", Sphere{radius});
  for (int i = 0; i < tile_grains; ++i) {
    const int x = i % side, y = i / side % side, z = i / side / side;
    const Vec3 at((x + 0.5 - 0.5 * side) * 2.3, (y + 0.5 - 0.5 * side) * 2.3, (z + 0.6) * 2.3);
    builder.body("grain", ball, {.position = radius * (at + Vec3(shift(random), shift(random), 0))}, size(random));
  }
  return builder.build();
}

/// How many periods lie between a tile and the one whose body b a contact meets.
struct Across {
  int x = 0, y = 0;
};

/// A contact problem with the impulses that the step before left.
struct Case {
  ConeProblem problem;
  std::vector<Across> across;  ///< of each contact
  std::vector<Impulse> warm;
};

/// The problem of the next step of `state`, in the world's own units, without impulses; spheres only.
Case next_problem(const Model& model, const Snapshot& state, ContactFinder& finder, std::vector<ContactId>& ids) {
  const Units units = units_of(model);
  const double h = step / units.time;
  std::vector<Vec3> position, velocity, angular_velocity;
  std::vector<Mat3> rotation;
  std::vector<double> turning_speed;
  const std::vector<char> present(model.bodies.size(), 1);
  const Vec3 fall = h * model.gravity * (units.time * units.time / units.length);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    position.push_back(state.position[i] / units.length);
    rotation.push_back(state.orientation[i].toRotationMatrix());
    velocity.push_back(state.velocity[i] / units.velocity() + (model.bodies[i].dynamic ? fall : Vec3::Zero()));
    angular_velocity.push_back(state.angular_velocity[i] * units.time);
    const double turning = angular_velocity.back().norm() * radius / units.length;
    turning_speed.push_back(model.bodies[i].dynamic ? turning : 0.0);
  }
  const std::vector<FoundContact>& found = finder.find({position, rotation, velocity, angular_velocity, turning_speed, present}, h, 1.0, 1);
  Case next;
  ConeProblem& problem = next.problem;
  std::vector<std::int32_t> slot(model.bodies.size());
  const auto add = [&](std::size_t body) {
    slot[body] = static_cast<std::int32_t>(problem.velocity.size());
    InverseMass m;
    if (model.bodies[body].dynamic) {
      m.mass = units.mass / model.bodies[body].mass;
      const double inertia = units.mass * units.length * units.length / model.bodies[body].inertia.x();
      m.inertia = {inertia, 0, 0, inertia, 0, inertia};
    }
    problem.inverse_mass.push_back(m);
    problem.velocity.push_back(velocity[body]);
    problem.angular_velocity.push_back(angular_velocity[body]);
  };
  for (std::int32_t body : finder.order()) add(static_cast<std::size_t>(body));
  problem.dynamic_bodies = static_cast<std::int32_t>(problem.velocity.size());
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (!model.bodies[i].dynamic) add(i);
  ids.clear();
  for (const FoundContact& f : found) {
    const auto a = static_cast<std::size_t>(f.id.a()), b = static_cast<std::size_t>(f.id.b());
    const PairLaw& law = model.law(model.bodies[a].material, model.bodies[b].material);
    const Vec3 shift = finder.image_shift(position, f.id.a(), f.id.b());
    const auto periods = [&](int axis) {
      return static_cast<int>(std::lround(shift[axis] * units.length / model.periodic.length(axis)));
    };
    next.across.push_back({periods(0), periods(1)});
    ConeContact c;
    c.a = slot[a];
    c.b = slot[b];
    c.normal = f.point.normal;
    c.arm_a = f.point.point - position[a];
    c.arm_b = f.point.point - position[b] - shift;
    c.bias = std::max(0.0, f.point.gap) / h;
    c.friction = law.friction;
    c.rolling = law.rolling_friction;
    c.spinning = law.spinning_friction;
    c.arm = reduced_radius(model.bodies[a].radius, model.bodies[b].radius) / units.length;
    problem.contacts.push_back(c);
    ids.push_back(f.id);
  }
  return next;
}

/// Runs the bed for `steps` and takes the problem that comes next, with the impulses of the last step.
Case poured(double rolling, int steps) {
  const Model model = bed(rolling);
  SolverOptions options;
  options.time_step = step;
  const auto world = make_world(model, options);
  const Snapshot state = run(*world, model, {step, steps * step, 1e9, 1e9}, nullptr, {}).final_state;
  ContactFinder finder(model, units_of(model).length);
  std::vector<ContactId> ids;
  Case c = next_problem(model, state, finder, ids);
  std::vector<Contact> contacts;
  world->read(contacts);
  std::unordered_map<std::uint64_t, Contact> last;
  for (const Contact& contact : contacts)
    last.emplace(static_cast<std::uint64_t>(contact.a) << 32 | static_cast<std::uint64_t>(contact.b), contact);
  const Units units = units_of(model);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Impulse g{};
    const auto at = last.find(ids[i].bodies);
    if (at != last.end()) {
      Vec3 t1, t2;
      const ConeContact& contact = c.problem.contacts[i];
      tangent_frame(contact.normal, t1, t2);
      const Vec3 force = at->second.force * (step / units.impulse());
      const Vec3 couple = at->second.torque * (step / units.impulse() / units.length / contact.arm);
      g = {std::max(0.0, contact.normal.dot(force)), t1.dot(force), t2.dot(force), t1.dot(couple), t2.dot(couple),
           contact.normal.dot(couple)};
    }
    c.warm.push_back(g);
  }
  return c;
}

/// So many tiles along x and along y.
struct Layout {
  int x = 1, y = 1;
  int tiles() const { return x * y; }
};

/// A tile repeated, as one problem: around the whole of it its sides are periodic, as the tile's were.
Case laid_out(const Case& tile, Layout layout) {
  Case result;
  const int n = tile.problem.dynamic_bodies;
  const auto bodies = static_cast<int>(tile.problem.velocity.size());
  ConeProblem& p = result.problem;
  p.dynamic_bodies = n * layout.tiles();
  const auto append = [&](int first, int last) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      p.inverse_mass.push_back(tile.problem.inverse_mass[i]);
      p.velocity.push_back(tile.problem.velocity[i]);
      p.angular_velocity.push_back(tile.problem.angular_velocity[i]);
    }
  };
  for (int k = 0; k < layout.tiles(); ++k) append(0, n);
  append(n, bodies);
  const auto body_of = [&](std::int32_t body, int x, int y) {
    if (body >= n) return body + n * (layout.tiles() - 1);  // the plate, below all
    const int column = (x + layout.x) % layout.x, row = (y + layout.y) % layout.y;
    return body + n * (row * layout.x + column);
  };
  for (int y = 0; y < layout.y; ++y)
    for (int x = 0; x < layout.x; ++x)
      for (std::size_t i = 0; i < tile.problem.contacts.size(); ++i) {
        ConeContact c = tile.problem.contacts[i];
        const Across& across = tile.across[i];
        c.a = body_of(c.a, x, y);
        c.b = body_of(c.b, x + across.x, y + across.y);
        p.contacts.push_back(c);
        result.warm.push_back(tile.warm[i]);
      }
  return result;
}

void sweep_cost(const Case& tile, const std::string& rows, const std::vector<Layout>& layouts) {
  for (const Layout& layout : layouts) {
    const Case c = laid_out(tile, layout);
    const Colouring colouring = colour_contacts(c.problem, 1);
    for (const int threads : {1, 2}) {
      PackedProblem<float> packed;
      pack<float>(c.problem, colouring, c.warm, threads, packed);
      const double contacts = static_cast<double>(c.problem.contacts.size());
      const int sweeps = std::max(4, static_cast<int>(2e6 / contacts));
      gauss_seidel<float>(packed, ContactLaw::exact, 2, 1.0, nullptr, threads);
      Momentum<float> momentum;
      momentum.begin(packed, threads);
      std::vector<double> time;
      for (int run = 0; run < 5; ++run) {
        const double start = seconds_now();
        gauss_seidel(packed, ContactLaw::exact, sweeps, 1.0, &momentum, threads);
        time.push_back((seconds_now() - start) / sweeps / contacts);
      }
      // Read and write the batch's impulses, read the rest; two bodies' velocities both ways and inverse masses one way.
      const double batch = static_cast<double>(packed.batches.size() * (sizeof(Batch<float>) + 6 * lane_bytes));
      const double bodies = contacts * 2 * (2 * sizeof(BodyVelocity<float>) + sizeof(BodyInverse<float>));
      const double bandwidth = memory_bandwidth(threads);
      const double stored = static_cast<double>(packed.bytes() + momentum.bytes()) +
                            contacts * static_cast<double>(sizeof(ConeContact) + sizeof(Impulse) + sizeof(std::int32_t));
      const auto [low, high] = std::minmax_element(time.begin(), time.end());
      fmt::print("| {} | {} | {:.0f} | {} | {:.1f} ({:.1f}-{:.1f}) | {:.0f} + {:.0f} | {:.1f} | {:.1f} | {:.0f} |\n", rows,
                 layout.tiles() * tile_grains, contacts, threads, 1e9 * median(time), 1e9 * *low, 1e9 * *high, batch / contacts,
                 bodies / contacts, bandwidth / 1e9, 1e9 * (batch / contacts) / bandwidth, stored / contacts);
      std::fflush(stdout);
    }
  }
}

void convergence(const Case& c, const std::string& name, int max_iterations) {
  const std::pair<SolverKind, const char*> kinds[] = {{SolverKind::gauss_seidel, "Gauss-Seidel"},
                                                      {SolverKind::apgd, "APGD"},
                                                      {SolverKind::barzilai_borwein, "Barzilai-Borwein"}};
  for (const auto& [kind, label] : kinds)
    for (const bool warm : {false, true}) {
      fmt::print("| {} | {} | {} |", name, label, warm ? "warm" : "cold");
      for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
        SolverOptions options;
        options.tolerance = tolerance;
        options.max_iterations = max_iterations;
        options.kind = kind;
        std::vector<Impulse> impulse = warm ? c.warm : std::vector<Impulse>(c.warm.size(), Impulse{});
        std::vector<Vec3> v, w;
        const double start = seconds_now();
        SolverRoom room;
        const SolveReport report = solve(c.problem, options, impulse, v, w, room);
        fmt::print(" {}{} / {:.3f} s |", report.converged ? "" : "not in ", report.iterations, seconds_now() - start);
        std::fflush(stdout);
      }
      fmt::print("\n");
    }
}

}  // namespace
}  // namespace repose::dvi

int main(int argc, char** argv) {
  using namespace repose::dvi;
  const bool quick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
  if (argc > 1 && !quick) {
    fmt::print("usage: dvi_bench [--quick]\n");
    return std::strcmp(argv[1], "--help") == 0 ? 0 : 2;
  }
  const int settled = quick ? 60 : 400, collapsing = quick ? 40 : 130;
  const std::vector<Layout> layouts = quick ? std::vector<Layout>{{1, 1}, {2, 1}} : std::vector<Layout>{{1, 1}, {5, 2}, {8, 8}};
  const Case full = poured(0.075, settled);
  const Case sliding = poured(0, settled);
  fmt::print("Gauss-Seidel, single precision, one sweep; bytes: contact + bodies; floor: contact bytes over triad bandwidth\n\n");
  fmt::print("| rows | grains | contacts | threads | ns per contact and sweep (range) | bytes | triad GB/s | floor ns | stored bytes per contact |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|\n");
  sweep_cost(sliding, "sliding", layouts);
  sweep_cost(full, "sliding, rolling, spinning", layouts);
  fmt::print("\nIterations (products with N for the gradients) and time to a residual, 2,000 grains, one thread\n\n");
  fmt::print("| bed | solver | start | 1e-3 | 1e-4 | 1e-5 |\n|---|---|---|---|---|---|\n");
  const int most = quick ? 300 : 20000;
  convergence(full, "settled", most);
  convergence(poured(0.075, collapsing), "collapsing column", most);
  return 0;
}
