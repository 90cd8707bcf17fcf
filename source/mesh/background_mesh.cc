#include <selkie/mesh/background_mesh.h>
#include <selkie/scene/imported_mesh.h>

#include <deal.II/grid/grid_generator.h>

#include <algorithm>

namespace selkie
{
  namespace
  {
    /// How often all numbers can be halved.
    template <std::size_t n>
    unsigned int
    common_halvings(std::array<unsigned int, n> numbers)
    {
      unsigned int halvings = 0;
      while (std::all_of(numbers.begin(), numbers.end(), [](unsigned int i) {
        return i > 0 && i % 2 == 0;
      }))
        {
          for (unsigned int &i : numbers)
            i /= 2;
          ++halvings;
        }
      return halvings;
    }

    /// Whether some of a lattice of sample points of the overlap of the cell
    /// and the shape's bounding box lies inside the shape. Sampling the
    /// overlap finds shapes that are much smaller than the cell, too.
    template <int dim, typename Cell>
    bool
    touches(const Cell &cell, const Shape<dim> &shape)
    {
      constexpr unsigned int n_samples = 9; // per direction
      const auto             box   = shape.bounding_box().get_boundary_points();
      dealii::Point<dim>     lower = cell->vertex(0);
      dealii::Point<dim>     upper = cell->vertex((1u << dim) - 1);
      unsigned int           n     = 1;
      for (unsigned int d = 0; d < dim; ++d)
        {
          lower[d] = std::max(lower[d], box.first[d]);
          upper[d] = std::min(upper[d], box.second[d]);
          if (lower[d] > upper[d])
            return false;
          n *= n_samples;
        }
      for (unsigned int i = 0; i < n; ++i)
        {
          dealii::Point<dim> x;
          for (unsigned int d = 0, rest = i; d < dim; rest /= n_samples, ++d)
            {
              const double s = (rest % n_samples) / (n_samples - 1.);
              x[d]           = (1. - s) * lower[d] + s * upper[d];
            }
          if (shape.contains(x))
            return true;
        }
      return false;
    }
  } // namespace


  template <int dim>
  std::unique_ptr<dealii::parallel::distributed::Triangulation<dim>>
  make_background_mesh(const Domain<dim> &domain, const MPI_Comm comm)
  {
    using Mesh = dealii::parallel::distributed::Triangulation<dim>;
    // p4est knows the vertices so that it can tell the owner of any point;
    // cells come in an order that does not depend on the mesh's history, so
    // that a resumed run is the same to the bit
    auto mesh = std::make_unique<Mesh>(
      comm,
      dealii::Triangulation<dim>::limit_level_difference_at_vertices,
      static_cast<typename Mesh::Settings>(
        Mesh::communicate_vertices_to_p4est |
        Mesh::mesh_reconstruction_after_repartitioning));
    reset_to_coarse_cells(domain, *mesh);
    const unsigned int base = base_level(domain);
    mesh->refine_global(base);

    unsigned int most_levels = 0;
    for (const auto &refinement : domain.refinements)
      most_levels = std::max(most_levels, refinement.levels);
    for (unsigned int pass = 0; pass < most_levels; ++pass)
      {
        for (const auto &cell : mesh->active_cell_iterators())
          if (cell->is_locally_owned() &&
              static_cast<unsigned int>(cell->level()) <
                refined_level<dim>(domain, cell))
            cell->set_refine_flag();
        mesh->execute_coarsening_and_refinement();
      }
    return mesh;
  }


  template <int dim>
  void
  reset_to_coarse_cells(const Domain<dim> &domain,
                        dealii::parallel::distributed::Triangulation<dim> &mesh)
  {
    mesh.clear();
    if (domain.mesh)
      {
        make_coarse_mesh(*domain.mesh, mesh);
        return;
      }
    std::vector<unsigned int> repetitions;
    for (const unsigned int n : domain.cells)
      repetitions.push_back(n >> base_level(domain));
    dealii::GridGenerator::subdivided_hyper_rectangle(
      mesh, repetitions, domain.lower, domain.upper, /*colorize=*/true);
  }


  template <int dim>
  unsigned int
  base_level(const Domain<dim> &domain)
  {
    return domain.mesh ? domain.mesh->global_refinements
                       : common_halvings(domain.cells);
  }


  template <int dim>
  unsigned int
  refined_level(
    const Domain<dim>                                               &domain,
    const typename dealii::Triangulation<dim>::active_cell_iterator &cell)
  {
    unsigned int levels = 0;
    for (const auto &refinement : domain.refinements)
      if (refinement.levels > levels && touches(cell, *refinement.shape))
        levels = refinement.levels;
    return levels > 0 ? base_level(domain) + levels : 0;
  }


#define INSTANTIATE(dim)                                                       \
  template std::unique_ptr<dealii::parallel::distributed::Triangulation<dim>>  \
                make_background_mesh(const Domain<dim> &, const MPI_Comm);     \
  template void reset_to_coarse_cells(                                         \
    const Domain<dim> &, dealii::parallel::distributed::Triangulation<dim> &); \
  template unsigned int base_level(const Domain<dim> &);                       \
  template unsigned int refined_level<dim>(                                    \
    const Domain<dim> &,                                                       \
    const dealii::Triangulation<dim>::active_cell_iterator &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
