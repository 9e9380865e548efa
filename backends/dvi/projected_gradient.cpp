#include "backends/dvi/projected_gradient.hpp"

#include <cmath>

#include "backends/dvi/batch_kernels.hpp"
#include "backends/dvi/team.hpp"

namespace repose::dvi {

namespace {

template <class Real>
struct alignas(lane_bytes) Rows {
  Lanes<Real> row[6];
};

template <class Real>
using RowField = std::vector<Rows<Real>>;

}  // namespace

template <class Real>
struct ProjectedGradient<Real>::Impl {
  PackedProblem<Real>& packed;
  const ConeProblem& problem;
  SolverKind kind;
  ContactLaw law;
  int threads;
  int rows;
  std::vector<OneLane<Real>> scale;       // l of each contact: the metric
  std::vector<OneLane<Real>> correction;  // of the normal row, frozen during a phase
  double step = 1;                      // of the scaled problem, whose N has eigenvalues of order one
  RowField<Real> g, gradient, g_next, gradient_next, y, gradient_y;

  Impl(PackedProblem<Real>& p, const ConeProblem& q, SolverKind k, ContactLaw l, int t)
      : packed(p), problem(q), kind(k), law(l), threads(t), rows(p.rotational ? 6 : 3) {
    const std::size_t n = packed.batches.size();
    scale.resize(n);
    correction.resize(n);
    for (RowField<Real>* field : {&g, &gradient, &g_next, &gradient_next, &y, &gradient_y}) field->resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      Lanes<Real> trace{};
      for (int k6 = 0; k6 < rows; ++k6) trace += packed.batches[i].w[block_index(k6, k6)];
      scale[i].x = trace / static_cast<Real>(rows);
      for (int k6 = 0; k6 < 6; ++k6) g[i].row[k6] = packed.batches[i].impulse[k6];
    }
  }

  template <class F>
  void each(F&& f) {
    const auto n = static_cast<std::ptrdiff_t>(packed.batches.size());
    on_team(threads, [&] {
#pragma omp for schedule(static)
      for (std::ptrdiff_t i = 0; i < n; ++i) f(static_cast<std::size_t>(i));
    });
  }

  /// Sum over contacts in a fixed order.
  template <class F>
  double sum(F&& f) {
    std::vector<double> part(packed.batches.size());
    each([&](std::size_t i) { part[i] = lane_sum<Real>(f(i)); });
    double total = 0;
    for (double p : part) total += p;
    return total;
  }

  Lanes<Real> row_dot(const Rows<Real>& a, const Rows<Real>& b) const {
    Lanes<Real> s{};
    for (int k = 0; k < rows; ++k) s += a.row[k] * b.row[k];
    return s;
  }

  /// gradient = J v(g) + e_n (bias + correction), with v the velocities that `impulse` gives.
  void product(const RowField<Real>& impulse, RowField<Real>& out, bool renew_correction) {
    each([&](std::size_t i) {
      for (int k = 0; k < 6; ++k) packed.batches[i].impulse[k] = impulse[i].row[k];
    });
    accumulate_velocities(packed, problem, threads);
    with_rows(packed, [&](auto rotational) {
      constexpr bool r = decltype(rotational)::value;
      each([&](std::size_t i) {
        const Batch<Real>& c = packed.batches[i];
        Lanes<Real> va[3], wa[3], vb[3], wb[3], t2[3];
        gather_velocity<Real>(packed.velocity.data(), c.a, va, wa);
        gather_velocity<Real>(packed.velocity.data(), c.b, vb, wb);
        second_tangent<Real>(c, t2);
        Lanes<Real>* u = out[i].row;
        relative_velocity<Real, r>(c, t2, packed.across, va, wa, vb, wb, u);
        if (renew_correction) correction[i].x = law == ContactLaw::exact ? de_saxce<Real, r>(c, u) : Lanes<Real>{};
        u[0] += c.bias + correction[i].x;
        add_compliance<Real>(packed, i, c.impulse[0], u[0]);
      });
    });
  }

  /// out = P_K(from - t gradient / l)
  void projected_step(const RowField<Real>& from, const RowField<Real>& slope, double t, RowField<Real>& out) {
    with_rows(packed, [&](auto rotational) {
      constexpr bool r = decltype(rotational)::value;
      each([&](std::size_t i) {
        const Lanes<Real> f = static_cast<Real>(t) / scale[i].x;
        for (int k = 0; k < rows; ++k) out[i].row[k] = from[i].row[k] - f * slope[i].row[k];
        project<Real, r>(packed.batches[i], out[i].row);
      });
    });
  }

  int barzilai_borwein(int iterations) {
    product(g, gradient, true);
    int products = 1;
    for (int it = 0; it < iterations; ++it) {
      projected_step(g, gradient, step, g_next);
      product(g_next, gradient_next, false);
      ++products;
      double ss = 0, sy = 0, yy = 0;
      const auto change = [&](std::size_t i, auto&& pick) {
        Rows<Real> s, d;
        for (int k = 0; k < rows; ++k) {
          s.row[k] = g_next[i].row[k] - g[i].row[k];
          d.row[k] = gradient_next[i].row[k] - gradient[i].row[k];
        }
        return pick(s, d);
      };
      ss = sum([&](std::size_t i) {
        return change(i, [&](auto& s, auto&) { return Lanes<Real>(scale[i].x * row_dot(s, s)); });
      });
      sy = sum([&](std::size_t i) { return change(i, [&](auto& s, auto& d) { return row_dot(s, d); }); });
      yy = sum([&](std::size_t i) {
        return change(i, [&](auto&, auto& d) { return Lanes<Real>(row_dot(d, d) / scale[i].x); });
      });
      std::swap(g, g_next);
      std::swap(gradient, gradient_next);
      if (!(sy > 0) || !(ss > 0)) break;
      // Long and short steps in turn; bounded, because the scaled N has eigenvalues of order one to the contact number.
      step = std::clamp(it % 2 == 0 ? ss / sy : sy / yy, 1e-3, 1e3);
    }
    return products;
  }

  int apgd(int iterations) {
    product(g, gradient, true);
    int products = 1;
    y = g;
    gradient_y = gradient;
    double theta = 1;
    for (int it = 0; it < iterations; ++it) {
      for (int halvings = 0; halvings < 30; ++halvings) {
        projected_step(y, gradient_y, step, g_next);
        product(g_next, gradient_next, false);
        ++products;
        // f is quadratic, so f(x) <= f(y) + slope + |x - y|^2 / 2t holds exactly when (x-y)'N(x-y) <= |x - y|^2 / t.
        double curved = 0, length = 0;
        curved = sum([&](std::size_t i) {
          Lanes<Real> s{};
          for (int k = 0; k < rows; ++k)
            s += (g_next[i].row[k] - y[i].row[k]) * (gradient_next[i].row[k] - gradient_y[i].row[k]);
          return s;
        });
        length = sum([&](std::size_t i) {
          Lanes<Real> s{};
          for (int k = 0; k < rows; ++k) s += (g_next[i].row[k] - y[i].row[k]) * (g_next[i].row[k] - y[i].row[k]);
          return Lanes<Real>(scale[i].x * s);
        });
        if (curved * step <= length * (1 + 1e-6) || length == 0) break;
        step *= 0.5;
      }
      const double uphill = sum([&](std::size_t i) {
        Lanes<Real> s{};
        for (int k = 0; k < rows; ++k) s += gradient_y[i].row[k] * (g_next[i].row[k] - g[i].row[k]);
        return s;
      });
      const double theta_next = 0.5 * (-theta * theta + theta * std::sqrt(theta * theta + 4));
      double beta = theta * (1 - theta) / (theta * theta + theta_next);
      theta = theta_next;
      if (uphill > 0) {  // the momentum points uphill: restart it
        beta = 0;
        theta = 1;
      }
      const Real b = static_cast<Real>(beta);
      each([&](std::size_t i) {
        for (int k = 0; k < rows; ++k) {
          y[i].row[k] = g_next[i].row[k] + b * (g_next[i].row[k] - g[i].row[k]);
          gradient_y[i].row[k] = gradient_next[i].row[k] + b * (gradient_next[i].row[k] - gradient[i].row[k]);
        }
      });
      std::swap(g, g_next);
      std::swap(gradient, gradient_next);
      step /= 0.9;
    }
    return products;
  }
};

template <class Real>
ProjectedGradient<Real>::ProjectedGradient(PackedProblem<Real>& packed, const ConeProblem& problem, SolverKind kind,
                                           ContactLaw law, int threads)
    : impl_(std::make_unique<Impl>(packed, problem, kind, law, threads)) {}

template <class Real>
ProjectedGradient<Real>::~ProjectedGradient() = default;

template <class Real>
int ProjectedGradient<Real>::phase(int iterations) {
  return impl_->kind == SolverKind::apgd ? impl_->apgd(iterations) : impl_->barzilai_borwein(iterations);
}

template class ProjectedGradient<double>;
template class ProjectedGradient<float>;

}  // namespace repose::dvi
