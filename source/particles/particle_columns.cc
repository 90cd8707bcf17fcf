#include <selkie/particles/particle_set.h>

namespace selkie
{
  namespace
  {
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
    const bool solid = scene.has_solid();
    const bool fluid = scene.has_fluid();
    const bool tpic  = moves && !scene.lagrangian_mesh() &&
                      scene.transfer.scheme == TransferScheme::tpic;
    const bool  lme    = scene.approximation == Approximation::lme_mpm;
    const bool  shape  = solid || scene.lagrangian_mesh();
    const char *m_unit = dim == 2 ? "kg/m" : "kg";
    const char *V_unit = dim == 2 ? "m^2" : "m^3";

    body   = fields.add<double>("body", "", true, Combine::label);
    mass   = fields.add<double>("mass", m_unit, true, Combine::sum);
    volume = fields.add<double>("reference volume", V_unit, true, Combine::sum);
    lambda = add_if<Vector>(lme, fields, "LME multiplier", "1/m", false);
    v      = add_if<Vector>(moves, fields, "velocity", "m/s", true);
    a      = add_if<Vector>(moves, fields, "acceleration", "m/s^2", false);
    X      = add_if<Vector>(shape, fields, "reference position", "m", true);
    F      = add_if<Matrix>(shape, fields, "deformation gradient", "", true);
    J      = add_if<double>(fluid, fields, "volume ratio", "", true);
    pressure = add_if<double>(fluid, fields, "pressure", "Pa", true);
    grad_v   = add_if<Matrix>(tpic, fields, "velocity gradient", "1/s", false);

    // Those of effects.
    for (const auto &active : scene.effects)
      active.effect->add_columns(scene, fields);
    X             = fields.find<Vector>("reference position");
    pressure      = fields.find<double>("pressure");
    mean_J        = fields.find<double>("mean volume ratio");
    traction_area = fields.find<double>("traction area");
  }


  template struct ParticleColumns<2>;
  template struct ParticleColumns<3>;
} // namespace selkie
