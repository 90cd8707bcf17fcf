#include <selkie/laws/hyperelastic_law.h>
#include <selkie/particles/fields.h>
#include <selkie/scene/check_scene.h>
#include <selkie/terms/effect_table.h>

#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The internal force of solids whose volume ratio is replaced by its mean
    /// over the patch, Jbar = sum V_0 J / sum V_0 (Nagtegaal's mean dilatation
    /// in the F-bar form of de Souza Neto et al. 1996, with the variationally
    /// consistent force: the tangent is symmetric). Stresses are those of
    /// Fbar = (Jbar / J)^{1/3} F; with m = tr tau / 3 and
    /// gbar_a = sum V_0 J g_a / sum V_0 J,
    ///
    ///   R_a = sum_p V_0 dev tau g_a + (sum_p V_0 m) gbar_a.
    ///
    /// The tangent is derived in doc/theory.md, section 2.
    template <int dim>
    class MeanDilatationTerm : public Term<dim>
    {
    public:
      std::string
      name() const override
      {
        return "elasticity (mean dilatation)";
      }

      TermUse
      use() const override
      {
        TermUse use;
        use.kinematics = true;
        use.stress     = true;
        use.mean       = true;
        return use;
      }

      bool
      acts_on(const PatchKind &kind) const override
      {
        return kind.integration && !kind.fluid;
      }

      void
      add(PatchState<dim> &state, const bool with_tangent) const override
      {
        const unsigned int n   = state.patch->n_points;
        double             V_0 = 0., V = 0.; // of the patch
        for (unsigned int q = 0; q < n; ++q)
          {
            const StepPoint<dim> &point = state.point(q);
            V_0 += point.volume;
            V += point.volume *
                 determinant(state.kinematics[q].f * extend(point.F_n));
          }

        auto &mean = state.mean;
        mean.gradient.resize(n);
        mean.coupling.resize(n);
        mean.force = mean.stiffness = 0.;
        std::vector<Tensor<2, 3>> dilatation(n); // response to the strain I
        std::vector<Stress>       stresses;
        stresses.reserve(n);
        for (unsigned int q = 0; q < n; ++q)
          {
            stresses.push_back(stress(state, q, V / V_0));
            const Stress &at     = stresses.back();
            const double  volume = state.point(q).volume;
            const auto   &kin    = state.kinematics[q];
            mean.force += volume * at.m;
            state.forms[q].add_stress(volume, at.tau - at.m * identity(), kin);
            for (unsigned int j = 0; j < dim; ++j)
              for (unsigned int i = 0; i < dim; ++i)
                mean.gradient[q][i][j] = volume * at.J / V * kin.c[j][i];
            if (with_tangent)
              dilatation[q] = response_to_dilatation(at);
          }
        if (!with_tangent)
          return;

        mean.stiffness = -mean.force;
        for (unsigned int q = 0; q < n; ++q)
          {
            const Stress       &at     = stresses[q];
            const double        volume = state.point(q).volume;
            const auto         &kin    = state.kinematics[q];
            const Tensor<2, 3> &D      = dilatation[q];
            const double        third  = trace(D) / 3.;
            mean.stiffness += volume * third / 3.;
            for (unsigned int j = 0; j < dim; ++j)
              {
                const Tensor<1, 3> e =
                  volume / 3. * (D * kin.c[j] - third * kin.c[j]);
                for (unsigned int i = 0; i < dim; ++i)
                  mean.coupling[q][i][j] = e[i];
              }
            const double p = mean.force * at.J / V;
            state.forms[q].add_tangent(
              volume,
              kin,
              [&](const Tensor<1, 3> &g_a, const Tensor<1, 3> &g_b) {
                return hyperelastic_tangent(
                         at.response, at.tau, at.b, g_a, g_b) +
                       outer_product((third / 3. + p) * g_a -
                                       1. / 3. * (D * g_a),
                                     g_b) -
                       outer_product(1. / 3. * g_a, D * g_b) +
                       (at.m - p) * outer_product(g_b, g_a);
              });
          }
      }

    private:
      /// Stress and tangent coefficients at Fbar.
      struct Stress
      {
        Tensor<2, 3>         b, tau;
        HyperelasticResponse response;
        double               m; ///< tr tau / 3 (Pa)
        double               J; ///< of F, not of Fbar
      };

      static Stress
      stress(const PatchState<dim> &state,
             const unsigned int     q,
             const double           mean_J)
      {
        const StepPoint<dim> &point = state.point(q);
        const auto &law      = static_cast<const HyperelasticLaw &>(*point.law);
        const Tensor<2, 3> F = state.kinematics[q].f * extend(point.F_n);
        Stress             at;
        at.J        = determinant(F);
        at.b        = left_cauchy_green(std::cbrt(mean_J / at.J) * F);
        at.response = law.response(invariants(at.b, mean_J));
        at.tau      = kirchhoff_stress(at.response, at.b);
        at.m        = trace(at.tau) / 3.;
        return at;
      }

      /// The change of tau (with its base vectors) for the velocity gradient I:
      /// of the law's tangent K(g_a, g_b) = d(tau g_a)/du_b the sum over
      /// du_b (x) g_b = e_k (x) e_k, without the change of g_a.
      static Tensor<2, 3>
      response_to_dilatation(const Stress &at)
      {
        Tensor<2, 3> D = at.tau;
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int k = 0; k < 3; ++k)
            {
              Tensor<1, 3> e_i, e_k;
              e_i[i] = e_k[k] = 1.;
              const Tensor<2, 3> A =
                hyperelastic_tangent(at.response, at.tau, at.b, e_i, e_k);
              for (unsigned int j = 0; j < 3; ++j)
                D[j][i] += A[j][k];
            }
        return D;
      }
    };


    template <int dim>
    class MeanDilatationEffect : public Effect<dim>
    {
    public:
      void
      check(const Scene<dim> &scene) const override
      {
        if (!scene.has_solid())
          fail(scene,
               "Effects",
               "'mean dilatation' is for solids, and every body of the scene "
               "is a fluid");
      }

      void
      add_columns(const Scene<dim> &, ParticleFields &fields) const override
      {
        fields.add<double>("mean volume ratio", "", true);
      }

      std::shared_ptr<const Term<dim>>
      term(const Scene<dim> &) const override
      {
        return std::make_shared<MeanDilatationTerm<dim>>();
      }
    };
  } // namespace

  EffectRow
  mean_dilatation_effect()
  {
    EffectRow row = effect_row<MeanDilatationEffect>(
      "mean dilatation",
      "",
      "Solids take the volume ratio's mean over a cell: no locking.",
      "a matrix, and in it a dense block of rank two for every cell of solids");
    row.replaces = "elasticity";
    return row;
  }
} // namespace selkie
