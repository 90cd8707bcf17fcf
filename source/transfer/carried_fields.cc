#include <selkie/transfer/carried_fields.h>
#include <selkie/transfer/vertex_values.h>

#include <deal.II/distributed/solution_transfer.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/lac/affine_constraints.h>

#include <cmath>
#include <limits>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Stands for a missing value on the way: see make_portable().
    constexpr double no_value = 1e300;
  } // namespace

  template <int dim>
  void
  CarriedFields<dim>::take(const Triangulation<dim>                    &mesh,
                           const DoFHandler<dim>                       &from,
                           const std::map<std::string, const Vector *> &fields)
  {
    dofs.reinit(mesh);
    n_layers = from.get_fe().n_components();
    values.clear();
    for (const auto &[name, field] : fields)
      values[name];
    reinit();
    AssertThrow(dofs.locally_owned_dofs() == from.locally_owned_dofs(),
                ExcInternalError()); // numbered alike: same mesh, same element
    for (const auto &[name, field] : fields)
      values[name].copy_locally_owned_data_from(*field);
    update_ghosts();
  }

  template <int dim>
  void
  CarriedFields<dim>::reinit()
  {
    dofs.distribute_dofs(FESystem<dim>(FE_Q<dim>(1), n_layers));
    IndexSet relevant;
    DoFTools::extract_locally_relevant_dofs(dofs, relevant);
    for (auto &[name, field] : values)
      field.reinit(dofs.locally_owned_dofs(),
                   relevant,
                   dofs.get_communicator());
  }

  template <int dim>
  void
  CarriedFields<dim>::update_ghosts()
  {
    for (auto &[name, field] : values)
      field.update_ghost_values();
  }

  template <int dim>
  void
  CarriedFields<dim>::carry_along(const std::function<void()> &change)
  {
    if (values.empty())
      {
        change();
        return;
      }
    for (auto &[name, field] : values)
      make_portable(field);
    parallel::distributed::SolutionTransfer<dim, Vector> transfer(dofs);
    transfer.prepare_for_coarsening_and_refinement(const_pointers());
    change();
    reinit();
    auto list = pointers();
    transfer.interpolate(list);
    for (auto &[name, field] : values)
      unmake_portable(field);
    update_ghosts();
  }

  template <int dim>
  void
  CarriedFields<dim>::carry_over(const std::function<void()> &rebuild)
  {
    if (values.empty())
      {
        dofs.clear();
        rebuild();
        return;
      }
    const auto       &mesh = dofs.get_triangulation();
    VertexValues<dim> before(*this);
    dofs.clear();
    rebuild();
    dofs.reinit(mesh);
    reinit();
    before.fill(*this);
    update_ghosts();
  }

  template <int dim>
  void
  CarriedFields<dim>::make_portable(Vector &field)
  {
    for (double &value : field)
      if (std::isnan(value))
        value = no_value;
    field.update_ghost_values();
  }

  template <int dim>
  void
  CarriedFields<dim>::unmake_portable(Vector &field)
  {
    for (double &value : field)
      if (std::abs(value) > 1e-3 * no_value)
        value = std::numeric_limits<double>::quiet_NaN();
  }

  template <int dim>
  void
  CarriedFields<dim>::make_continuous()
  {
    IndexSet relevant;
    DoFTools::extract_locally_relevant_dofs(dofs, relevant);
    AffineConstraints<double> hanging(relevant);
    DoFTools::make_hanging_node_constraints(dofs, hanging);
    hanging.close();
    for (auto &[name, field] : values)
      {
        field.zero_out_ghost_values();
        for (double &value : field)
          if (std::isnan(value))
            value = 0.;
        hanging.distribute(field);
      }
    update_ghosts();
  }

  template <int dim>
  std::vector<Vector *>
  CarriedFields<dim>::pointers()
  {
    std::vector<Vector *> list;
    for (auto &[name, field] : values)
      list.push_back(&field);
    return list;
  }

  template <int dim>
  std::vector<const Vector *>
  CarriedFields<dim>::const_pointers() const
  {
    std::vector<const Vector *> list;
    for (const auto &[name, field] : values)
      list.push_back(&field);
    return list;
  }

  template struct CarriedFields<2>;
  template struct CarriedFields<3>;
} // namespace selkie
