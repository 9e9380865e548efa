/// The exact law keeps sliding and rolling contacts closed; the convex relaxation makes them hop by a known height.
#include <algorithm>
#include <cmath>

#include "tests/physics/answer.hpp"
#include "tests/physics/simulate.hpp"

namespace repose::test {
namespace {

// The choice of the law is DVI's alone.
constexpr const char* backend = "dvi";
constexpr double g = 9.81, mu = 0.5, v0 = 0.1, radius = 29e-6, h = 1e-5;

enum class Slider { block, sphere, rolling_sphere };

Model slider(Slider kind, double rolling = 0) {
  ModelBuilder builder;
  builder.material("pa12", 1020).law("pa12", "pa12", {.friction = mu, .rolling_friction = rolling}).floor("pa12");
  if (kind == Slider::block)
    return builder.box("pa12", {2 * radius, radius, radius}, {.position = {0, 0, radius}, .velocity = {v0, 0, 0}})
        .build();
  const double spin = kind == Slider::rolling_sphere ? v0 / radius : 0;
  return builder
      .sphere("pa12", radius, {.position = {0, 0, radius}, .velocity = {v0, 0, 0}, .angular_velocity = {0, spin, 0}})
      .build();
}

SolverOptions with(ContactLaw law) {
  SolverOptions options = precise(h);
  options.law = law;
  return options;
}

/// Top of a hop that starts with `speed` at height 0 and falls by g h per step.
double discrete_top(double speed) {
  double top = 0;
  for (double v = speed; v > 0; v -= g * h) top += h * v;
  return top;
}

double hop(Slider kind, ContactLaw law, int steps, double rolling = 0) {
  Simulation s(backend, slider(kind, rolling), with(law));
  double top = 0;
  s.run(steps, [&](const Simulation& now) { top = std::max(top, now.position(1).z() - radius); });
  return top;
}

TEST(Law, TheRelaxedOneHopsByTheKnownHeight) {
  struct Case {
    Slider kind;
    const char* name;
    double inverse_mass;  ///< of the contact's sliding direction, times m
  };
  for (const Case& c : {Case{Slider::block, "block", 1.0}, Case{Slider::sphere, "sphere", 3.5}}) {
    const double speed = (mu * v0 + g * h) / (1 + c.inverse_mass * mu * mu) - g * h;
    const double closed = std::pow(mu * v0 / (1 + c.inverse_mass * mu * mu), 2) / (2 * g);
    expect_answer({std::string("relaxed law, hop of a 58 um ") + c.name + " sliding at 0.1 m/s [um]", 1e6 * closed,
                   1e6 * hop(c.kind, ContactLaw::relaxed, 500), 1e-9, 1e6 * discrete_top(speed)});
    note(std::string("that hop / radius, ") + c.name, closed / radius);
  }
}

TEST(Law, TheRelaxedOneThenStandsAtAGap) {
  Simulation s(backend, slider(Slider::block), with(ContactLaw::relaxed));
  s.run(1200);
  const double gap = s.position(1).z() - radius;
  expect_answer({"relaxed law, gap of the sliding block / (h mu v)", 1, gap / (h * mu * s.velocity(1).x()), 0.02});
}

TEST(Law, TheExactOneDoesNotHop) {
  expect_answer({"exact law, sliding block: highest rise / R", 0, hop(Slider::block, ContactLaw::exact, 1000) / radius,
                 1e-9, 0, 1});
  expect_answer({"exact law, sliding sphere: highest rise / R", 0,
                 hop(Slider::sphere, ContactLaw::exact, 1000) / radius, 1e-9, 0, 1});
}

TEST(Law, ARollingSphereHopsOnlyWithTheRelaxedOne) {
  const double rho = 0.5;
  const double relaxed = hop(Slider::rolling_sphere, ContactLaw::relaxed, 500, rho);
  note("relaxed law, hop of a rolling sphere, rho = 0.5 / R", relaxed / radius);
  EXPECT_GT(relaxed, 0.1 * radius);
  expect_answer({"exact law, rolling sphere, rho = 0.5: highest rise / R", 0,
                 hop(Slider::rolling_sphere, ContactLaw::exact, 1000, rho) / radius, 1e-9, 0, 1});
}

TEST(Law, TheExactOneIsCheapWhereItSlides) {
  for (const Slider kind : {Slider::block, Slider::sphere}) {
    SolverOptions options = usual(h, 1e-6);
    Simulation s(backend, slider(kind, 0.05), options);
    int iterations = 0, most = 0;
    double residual = 0;
    s.run(1000, [&](const Simulation& now) {
      iterations += now.report().iterations;
      most = std::max(most, now.report().iterations);
      residual = std::max(residual, now.report().residual);
      EXPECT_TRUE(now.report().converged);
    });
    const std::string name = kind == Slider::block ? "block" : "sphere";
    note("exact law, sliding " + name + ": iterations per step to 1e-6", iterations / 1000.0);
    note("exact law, sliding " + name + ": most iterations of a step", most);
    EXPECT_LT(most, 100);
    EXPECT_LE(residual, 1e-6);
  }
}

}  // namespace
}  // namespace repose::test
