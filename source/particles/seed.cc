#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/particles/seed.h>
#include <selkie/scene/check_scene.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/base/utilities.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/grid/cell_id.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <random>
#include <sstream>
#include <string>

namespace selkie
{
  namespace
  {
    template <int dim>
    using Mesh = dealii::parallel::distributed::Triangulation<dim>;

    /// Points keep this distance from the faces of their cell when jittered,
    /// in cells.
    constexpr double margin = 1e-4;

    /// The locally owned cells along p4est's space-filling curve, on which
    /// the ranks' pieces follow each other: a global order of all cells that
    /// does not depend on the partition. It is the order of the CellIds (whose
    /// coarse numbers are those of p4est's trees).
    template <int dim>
    std::vector<typename Mesh<dim>::active_cell_iterator>
    cells_on_curve(const Mesh<dim> &mesh)
    {
      using Cell = typename Mesh<dim>::active_cell_iterator;
      std::vector<std::pair<dealii::CellId, Cell>> keys;
      for (const auto &cell : mesh.active_cell_iterators())
        if (cell->is_locally_owned())
          keys.emplace_back(cell->id(), cell);
      std::sort(keys.begin(), keys.end(), [](const auto &a, const auto &b) {
        return a.first < b.first;
      });
      std::vector<Cell> cells;
      for (const auto &key : keys)
        cells.push_back(key.second);
      return cells;
    }

    /// Uniform numbers in [-1, 1] that depend on cell and body only; not from
    /// std::uniform_real_distribution, whose numbers depend on the library.
    class Jitter
    {
    public:
      template <typename Cell>
      Jitter(const Cell &cell, const unsigned int body)
      {
        const dealii::CellId      id   = cell->id();
        std::vector<unsigned int> seed = {
          body, static_cast<unsigned int>(id.get_coarse_cell_id())};
        for (const auto child : id.get_child_indices())
          seed.push_back(child);
        std::seed_seq sequence(seed.begin(), seed.end());
        generator.seed(sequence);
      }

      double
      operator()()
      {
        return 2. * generator() / 4294967295. - 1.;
      }

    private:
      std::mt19937 generator;
    };

    template <int dim>
    dealii::Point<dim>
    in_cell(const dealii::Point<dim> &lower,
            const dealii::Point<dim> &upper,
            const dealii::Point<dim> &reference)
    {
      dealii::Point<dim> x;
      for (unsigned int d = 0; d < dim; ++d)
        x[d] = (1. - reference[d]) * lower[d] + reference[d] * upper[d];
      return x;
    }

    template <int dim>
    bool
    boxes_meet(const dealii::BoundingBox<dim> &box,
               const dealii::Point<dim>       &lower,
               const dealii::Point<dim>       &upper)
    {
      for (unsigned int d = 0; d < dim; ++d)
        if (box.lower_bound(d) > upper[d] || box.upper_bound(d) < lower[d])
          return false;
      return true;
    }

    /// Ends with a SceneError about the shape of a body.
    template <int dim>
    [[noreturn]] void
    fail_shape(const Scene<dim>  &scene,
               const unsigned int body,
               const std::string &why)
    {
      fail(scene, "Bodies/" + scene.bodies[body].name + "/Shape", why);
    }

    /// Throws SceneError when another body claims a point, too.
    template <int dim>
    void
    check_claim(const Scene<dim>         &scene,
                const unsigned int        body,
                const dealii::Point<dim> &x)
    {
      for (unsigned int other = 0; other < scene.bodies.size(); ++other)
        if (other != body && scene.bodies[other].shape->contains(x))
          {
            const unsigned int later = std::max(body, other);
            std::ostringstream out;
            out << "the bodies '" << scene.bodies[std::min(body, other)].name
                << "' and '" << scene.bodies[later].name
                << "' overlap: both claim the material point at (" << x
                << "); allowed are bodies that at most touch, with no point "
                   "on the common face";
            fail_shape(scene, later, out.str());
          }
    }

    /// The points of one body in one cell.
    template <int dim>
    void
    seed_cell(const Scene<dim>                               &scene,
              const unsigned int                              b,
              const typename Mesh<dim>::active_cell_iterator &cell,
              std::vector<Seed<dim>>                         &seeds)
    {
      const Body<dim>         &body  = scene.bodies[b];
      const unsigned int       n     = body.points_per_direction;
      const dealii::Point<dim> lower = cell->vertex(0);
      const dealii::Point<dim> upper = cell->vertex((1u << dim) - 1);
      if (!boxes_meet(body.shape->bounding_box(), lower, upper))
        return;
      const unsigned int n_points = dealii::Utilities::pow(n, dim);
      Jitter             jitter(cell, b);
      double             volume = 1. / n_points;
      for (unsigned int d = 0; d < dim; ++d)
        volume *= upper[d] - lower[d];
      for (unsigned int i = 0; i < n_points; ++i)
        {
          dealii::Point<dim> regular, moved;
          for (unsigned int d = 0, rest = i; d < dim; rest /= n, ++d)
            {
              regular[d] = (rest % n + 0.5) / n;
              moved[d]   = std::clamp(regular[d] + jitter() * body.jitter / n,
                                    margin,
                                    1. - margin);
            }
          if (!body.shape->contains(in_cell(lower, upper, regular)))
            continue;
          const bool inside =
            body.jitter > 0 &&
            body.shape->contains(in_cell(lower, upper, moved));
          const auto reference = inside ? moved : regular;
          const auto x         = in_cell(lower, upper, reference);
          check_claim(scene, b, x);
          seeds.push_back({cell, x, reference, b, volume, 0});
        }
    }

    /// The Gauss points of a body's elements.
    template <int dim>
    struct ElementPoints
    {
      explicit ElementPoints(const unsigned int per_direction)
        : gauss(per_direction)
        , values(element,
                 gauss,
                 dealii::update_quadrature_points | dealii::update_JxW_values)
      {}

      const dealii::FE_Q<dim>   element{1};
      const dealii::QGauss<dim> gauss;
      dealii::FEValues<dim>     values;
    };

    /// The Gauss points of a finite element, which belongs to the body that
    /// holds its centre.
    template <int dim>
    void
    seed_element(const Scene<dim>                               &scene,
                 const unsigned int                              b,
                 const typename Mesh<dim>::active_cell_iterator &cell,
                 ElementPoints<dim>                             &points,
                 std::vector<Seed<dim>>                         &seeds)
    {
      if (!scene.bodies[b].shape->contains(cell->center()))
        return;
      check_claim(scene, b, cell->center());
      points.values.reinit(
        static_cast<const typename dealii::Triangulation<dim>::cell_iterator &>(
          cell));
      for (unsigned int q = 0; q < points.gauss.size(); ++q)
        seeds.push_back({cell,
                         points.values.quadrature_point(q),
                         points.gauss.point(q),
                         b,
                         points.values.JxW(q),
                         0});
    }

    template <int dim>
    void
    seed_cells(const Scene<dim>       &scene,
               const Mesh<dim>        &mesh,
               std::vector<Seed<dim>> &seeds)
    {
      for (const auto &cell : cells_on_curve(mesh))
        for (unsigned int b = 0; b < scene.bodies.size(); ++b)
          seed_cell(scene, b, cell, seeds);
    }

    template <int dim>
    void
    seed_elements(const Scene<dim>       &scene,
                  const Mesh<dim>        &mesh,
                  std::vector<Seed<dim>> &seeds)
    {
      std::deque<ElementPoints<dim>> points; // FEValues do not move
      for (const auto &body : scene.bodies)
        points.emplace_back(body.points_per_direction);
      for (const auto &cell : cells_on_curve(mesh))
        for (unsigned int b = 0; b < scene.bodies.size(); ++b)
          seed_element(scene, b, cell, points[b], seeds);
    }

    /// Volumes of the bodies' points on all ranks. Throws SceneError when one
    /// has none.
    template <int dim>
    std::vector<double>
    seeded_volumes(const Scene<dim>             &scene,
                   const std::vector<Seed<dim>> &seeds,
                   const MPI_Comm                comm)
    {
      std::vector<double> sums(scene.bodies.size(), 0.);
      for (const auto &seed : seeds)
        sums[seed.body] += seed.volume;
      dealii::Utilities::MPI::sum(sums, comm, sums);
      for (unsigned int b = 0; b < sums.size(); ++b)
        if (sums[b] == 0.)
          fail_shape(scene,
                     b,
                     "the body '" + scene.bodies[b].name +
                       "' gets no material point; allowed is a shape that "
                       "holds " +
                       (scene.lagrangian_mesh()
                          ? "the centre of a cell"
                          : "lattice points: finer cells or more points per "
                            "direction have more"));
      return sums;
    }

    /// Finite elements fill their body, those of the box's lattice exactly.
    template <int dim>
    void
    check_fit(const Scene<dim> &scene, const std::vector<double> &volumes)
    {
      const double tolerance = scene.domain.mesh ? 0.1 : 1e-6;
      for (unsigned int b = 0; b < volumes.size(); ++b)
        {
          const double exact = scene.bodies[b].shape->volume();
          if (std::abs(volumes[b] - exact) <= tolerance * exact)
            continue;
          std::ostringstream out;
          out << "the body '" << scene.bodies[b].name << "' has a volume of "
              << exact << " m^" << dim << ", the cells of the mesh inside it "
              << volumes[b]
              << "; allowed with 'q4 fem' is a mesh that is fitted to the "
                 "bodies: 'Domain/Cells' so that the body's faces are cells' "
                 "faces, or an imported one (Domain/Mesh)";
          fail_shape(scene, b, out.str());
        }
    }

    /// Scales the points' volumes to the exact ones of the bodies.
    template <int dim>
    void
    scale_volumes(const Scene<dim>          &scene,
                  const std::vector<double> &volumes,
                  std::vector<Seed<dim>>    &seeds)
    {
      std::vector<double> factors; // a shape may have to sample its volume
      for (unsigned int b = 0; b < scene.bodies.size(); ++b)
        factors.push_back(scene.bodies[b].shape->volume() / volumes[b]);
      for (auto &seed : seeds)
        seed.volume *= factors[seed.body];
    }

    /// Numbers the points in their order, which is a global one.
    template <int dim>
    void
    number(std::vector<Seed<dim>> &seeds, const MPI_Comm comm)
    {
      const unsigned long long n     = seeds.size();
      unsigned long long       first = 0;
      const auto counts = dealii::Utilities::MPI::all_gather(comm, n);
      for (unsigned int r = 0;
           r < dealii::Utilities::MPI::this_mpi_process(comm);
           ++r)
        first += counts[r];
      for (auto &seed : seeds)
        seed.id = first++;
    }
  } // namespace


  template <int dim>
  std::vector<Seed<dim>>
  seed_points(const Scene<dim>                                        &scene,
              const dealii::parallel::distributed::Triangulation<dim> &mesh)
  {
    const MPI_Comm         comm = mesh.get_communicator();
    std::vector<Seed<dim>> seeds;
    fail_together<SceneError>(comm, [&] {
      scene.lagrangian_mesh() ? seed_elements(scene, mesh, seeds)
                              : seed_cells(scene, mesh, seeds);
    });
    const auto volumes = seeded_volumes(scene, seeds, comm);
    if (scene.lagrangian_mesh())
      check_fit(scene, volumes);
    else
      scale_volumes(scene, volumes, seeds);
    number(seeds, comm);
    return seeds;
  }


  template std::vector<Seed<2>>
  seed_points(const Scene<2> &,
              const dealii::parallel::distributed::Triangulation<2> &);
  template std::vector<Seed<3>>
  seed_points(const Scene<3> &,
              const dealii::parallel::distributed::Triangulation<3> &);
} // namespace selkie
