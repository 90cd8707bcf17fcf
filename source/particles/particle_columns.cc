#include <selkie/particles/particle_set.h>

#include <algorithm>

namespace selkie
{
  namespace
  {
    template <int dim>
    bool
    has_solid(const Scene<dim> &scene)
    {
      return std::any_of(scene.bodies.begin(),
                         scene.bodies.end(),
                         [](const Body<dim> &body) {
                           return body.law->phase() == Phase::solid;
                         });
    }

    template <int dim>
    bool
    has_fluid(const Scene<dim> &scene)
    {
      return std::any_of(scene.bodies.begin(),
                         scene.bodies.end(),
                         [](const Body<dim> &body) {
                           return body.law->phase() == Phase::fluid;
                         });
    }

    /// Whether something depends on where points were at the start.
    template <int dim>
    bool
    needs_reference_position(const Scene<dim> &scene)
    {
      using Kind = typename Probe<dim>::Kind;
      return has_solid(scene) || scene.lagrangian_mesh() ||
             scene.body_force != nullptr || !scene.tractions.empty() ||
             std::any_of(scene.probes.begin(),
                         scene.probes.end(),
                         [](const Probe<dim> &probe) {
                           return probe.kind == Kind::point ||
                                  probe.kind == Kind::region;
                         });
    }

    /// The column, if it is needed; else one that does not exist.
    template <typename T>
    Column<T>
    add_if(const bool         needed,
           ParticleFields    &fields,
           const std::string &name,
           const std::string &unit,
           const bool         output)
    {
      return needed ? fields.add<T>(name, unit, output) : Column<T>();
    }
  } // namespace


  template <int dim>
  ParticleColumns<dim>::ParticleColumns(const Scene<dim> &scene,
                                        ParticleFields   &fields)
  {
    using Vector     = dealii::Tensor<1, dim>;
    using Matrix     = dealii::Tensor<2, dim>;
    const bool moves = scene.inertia.has_value();
    const bool solid = has_solid(scene);
    const bool fluid = has_fluid(scene);
    const bool tpic =
      !scene.lagrangian_mesh() && scene.transfer.scheme == TransferScheme::tpic;
    const bool  lme    = scene.approximation == Approximation::lme_mpm;
    const bool  shape  = solid || scene.lagrangian_mesh();
    const bool  starts = needs_reference_position(scene);
    const bool  loaded = !scene.lagrangian_mesh() && !scene.tractions.empty();
    const char *m_unit = dim == 2 ? "kg/m" : "kg";
    const char *V_unit = dim == 2 ? "m^2" : "m^3";
    const char *A_unit = dim == 2 ? "m" : "m^2";

    body   = fields.add<double>("body", "", true);
    mass   = fields.add<double>("mass", m_unit, true);
    volume = fields.add<double>("reference volume", V_unit, true);
    lambda = add_if<Vector>(lme, fields, "LME multiplier", "1/m", false);
    X      = add_if<Vector>(starts, fields, "reference position", "m", true);
    v      = add_if<Vector>(moves, fields, "velocity", "m/s", true);
    a      = add_if<Vector>(moves, fields, "acceleration", "m/s^2", false);
    F      = add_if<Matrix>(shape, fields, "deformation gradient", "", true);
    J      = add_if<double>(fluid, fields, "volume ratio", "", true);
    mean_J = add_if<double>(
      scene.mean_dilatation, fields, "mean volume ratio", "", true);
    pressure = add_if<double>(fluid, fields, "pressure", "Pa", true);
    grad_v   = add_if<Matrix>(tpic, fields, "velocity gradient", "1/s", false);
    traction_area =
      add_if<double>(loaded, fields, "traction area", A_unit, false);
  }


  template struct ParticleColumns<2>;
  template struct ParticleColumns<3>;
} // namespace selkie
