#pragma once

#include <selkie/scene/scene.h>
#include <selkie/terms/term.h>

#include <memory>
#include <vector>

namespace selkie
{
  /// The terms that the scene's effects call for, and no others, in a fixed
  /// order.
  template <int dim>
  std::vector<std::unique_ptr<const Term<dim>>>
  make_terms(const Scene<dim> &scene);

  // One factory a term; each is defined in the file of its name.
  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_inertia(const Inertia &inertia);

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_elasticity();

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_mean_dilatation();

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_fluid_pressure();

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_pressure_stabilisation(const double alpha);

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_viscosity();

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_gravity(const dealii::Tensor<1, dim> &g);

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_body_force(std::shared_ptr<VectorExpression<dim>> force);

  template <int dim>
  std::unique_ptr<const Term<dim>>
  make_traction(const std::vector<Traction<dim>> &tractions);
} // namespace selkie
