#include <selkie/base/exceptions.h>
#include <selkie/scene/imported_mesh.h>

#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_in.h>
#include <deal.II/grid/grid_tools.h>

#include <cmath>
#include <sstream>

namespace selkie
{
  using namespace dealii;

  template <int dim>
  void
  make_coarse_mesh(const ImportedMesh &mesh, Triangulation<dim> &triangulation)
  {
    try
      {
        if (!mesh.file.empty())
          {
            GridIn<dim> reader(triangulation);
            reader.read(mesh.file);
          }
        else
          GridGenerator::generate_from_name_and_arguments(triangulation,
                                                          mesh.generator,
                                                          mesh.arguments);
      }
    catch (const std::exception &error)
      {
        const auto *exception = dynamic_cast<const ExceptionBase *>(&error);
        std::ostringstream why;
        if (exception != nullptr)
          exception->print_info(why);
        else
          why << error.what();
        throw SceneError("Domain/Mesh: deal.II cannot make a mesh from " +
                         (mesh.file.empty()
                            ? "the generator '" + mesh.generator +
                                "' with the arguments '" + mesh.arguments + "'"
                            : "the file '" + mesh.file + "'") +
                         ": " + why.str());
      }
  }

  template <int dim>
  void
  fit_box(Domain<dim> &domain)
  {
    Triangulation<dim> coarse;
    make_coarse_mesh(*domain.mesh, coarse);
    const auto box = GridTools::compute_bounding_box(coarse);
    domain.lower   = box.get_boundary_points().first;
    domain.upper   = box.get_boundary_points().second;
    // Only a measure of the cells' size from here on.
    const double per_direction = std::pow(coarse.n_active_cells(), 1. / dim) *
                                 std::pow(2., domain.mesh->global_refinements);
    domain.cells.fill(std::max(1., std::round(per_direction)));
  }

#define INSTANTIATE(dim)                                                      \
  template void make_coarse_mesh(const ImportedMesh &, Triangulation<dim> &); \
  template void fit_box(Domain<dim> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
