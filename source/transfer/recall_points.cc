#include <selkie/laws/volumetric_part.h>
#include <selkie/transfer/recall_points.h>

#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/mapping_q1.h>
#include <deal.II/matrix_free/fe_point_evaluation.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// What the nodes' fields are at the points of a cell.
    template <int dim>
    class FieldsInCell
    {
    public:
      explicit FieldsInCell(const CarriedFields<dim> &fields)
        : fields(fields)
        , evaluator(mapping, element, update_values | update_gradients)
        , of_nodes(element.n_dofs_per_cell())
      {}

      void
      reinit(const typename Triangulation<dim>::active_cell_iterator &on_mesh,
             const std::vector<Point<dim>> &references)
      {
        using Cell = typename DoFHandler<dim>::active_cell_iterator;
        cell       = Cell(&on_mesh->get_triangulation(),
                    on_mesh->level(),
                    on_mesh->index(),
                    &fields.dofs);
        n_points   = references.size();
        evaluator.reinit(on_mesh, make_array_view(references));
      }

      /// Calls action(q, value, gradient) for all points.
      template <typename Action>
      void
      evaluate(const std::string &name, const Action &action)
      {
        cell->get_dof_values(fields.values.at(name),
                             of_nodes.begin(),
                             of_nodes.end());
        evaluator.evaluate(make_array_view(of_nodes),
                           EvaluationFlags::values |
                             EvaluationFlags::gradients);
        for (unsigned int q = 0; q < n_points; ++q)
          action(q,
                 evaluator.get_value(q),
                 Tensor<1, dim>(evaluator.get_gradient(q)));
      }

    private:
      const CarriedFields<dim>                      &fields;
      const MappingQ1<dim>                           mapping;
      const FE_Q<dim>                                element{1};
      FEPointEvaluation<1, dim>                      evaluator;
      typename DoFHandler<dim>::active_cell_iterator cell;
      unsigned int                                   n_points = 0;
      std::vector<double>                            of_nodes;
    };

    /// The points of one cell.
    template <int dim>
    using Points = std::vector<Particles::ParticleIterator<dim>>;

    template <int dim>
    void
    set_motion(const ParticleColumns<dim> &columns,
               FieldsInCell<dim>          &fields,
               const Points<dim>          &points)
    {
      std::vector<Tensor<1, dim>> u(points.size()), v(u), a(u);
      std::vector<Tensor<2, dim>> F(points.size());
      for (unsigned int d = 0; d < dim; ++d)
        {
          const auto collect = [&](const std::string           &name,
                                   std::vector<Tensor<1, dim>> &vectors) {
            fields.evaluate(component_name(name, d),
                            [&](const unsigned int q,
                                const double       value,
                                const auto &) { vectors[q][d] = value; });
          };
          fields.evaluate(component_name("displacement", d),
                          [&](const unsigned int    q,
                              const double          value,
                              const Tensor<1, dim> &gradient) {
                            u[q][d] = value;
                            F[q][d] = gradient;
                            F[q][d][d] += 1.;
                          });
          if (columns.v.exists())
            {
              collect("velocity", v);
              collect("acceleration", a);
            }
        }
      for (unsigned int q = 0; q < points.size(); ++q)
        {
          auto       point = points[q];
          const auto mine  = point->get_properties();
          point->set_location(Point<dim>(columns.X(mine) + u[q]));
          columns.F.set(mine, F[q]);
          if (!columns.v.exists())
            continue;
          columns.v.set(mine, v[q]);
          columns.a.set(mine, a[q]);
        }
    }

    /// Mean dilatation: all points of the cell have its volume ratio.
    template <int dim>
    void
    set_mean_J(const ParticleColumns<dim> &columns, const Points<dim> &points)
    {
      double V_0 = 0., V = 0.;
      for (const auto &point : points)
        {
          const auto   mine = point->get_properties();
          const double V_q  = columns.volume(mine);
          V_0 += V_q;
          V += V_q * determinant(columns.F(mine));
        }
      for (auto point : points)
        columns.mean_J.set(point->get_properties(), V / V_0);
    }

    /// The volume ratios are those of the nodes' pressure.
    template <int dim>
    void
    set_pressure(const ParticleSet<dim> &particles,
                 FieldsInCell<dim>      &fields,
                 const Points<dim>      &points)
    {
      const auto &columns = particles.columns;
      const auto  body    = static_cast<unsigned int>(
        columns.body(points.front()->get_properties()));
      const Scene<dim> &scene = particles.scene;
      const Law        &law   = *scene.bodies[body].law;
      if (!scene.bodies[body].has_pressure)
        {
          if (scene.mixed_solids) // what the law sees as J
            for (auto point : points)
              {
                const auto mine = point->get_properties();
                columns.mean_J.set(mine, determinant(columns.F(mine)));
              }
          return;
        }
      fields.evaluate(scene.pressure_name(scene.bodies[body].phase),
                      [&](const unsigned int q, const double p, const auto &) {
                        auto       point = points[q];
                        const auto mine  = point->get_properties();
                        columns.pressure.set(mine, p);
                        (law.phase() == Phase::fluid ? columns.J
                                                     : columns.mean_J)
                          .set(mine, volumetric_part(law).J_of_pressure(p));
                      });
    }
  } // namespace


  template <int dim>
  void
  recall_points(ParticleSet<dim> &particles, const CarriedFields<dim> &fields)
  {
    const auto             &scene   = particles.scene;
    const auto             &columns = particles.columns;
    auto                   &handler = particles.handler();
    FieldsInCell<dim>       in_cell(fields);
    Points<dim>             points;
    std::vector<Point<dim>> references;
    for (auto point = handler.begin(); point != handler.end();)
      {
        const auto cell = point->get_surrounding_cell();
        points.clear();
        references.clear();
        for (; point != handler.end() && point->get_surrounding_cell() == cell;
             ++point)
          {
            points.push_back(point);
            references.push_back(point->get_reference_location());
          }
        in_cell.reinit(cell, references);
        set_motion(columns, in_cell, points);
        if (columns.mean_J.exists() && !scene.mixed_solids)
          set_mean_J(columns, points);
        if (scene.has_pressure())
          set_pressure(particles, in_cell, points);
      }
  }


  template void
  recall_points(ParticleSet<2> &, const CarriedFields<2> &);
  template void
  recall_points(ParticleSet<3> &, const CarriedFields<3> &);
} // namespace selkie
