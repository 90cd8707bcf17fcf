#include <selkie/base/exceptions.h>
#include <selkie/scene/imported_mesh.h>

#include <deal.II/base/geometry_info.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_in.h>
#include <deal.II/grid/grid_tools.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// @p text in one line: deal.II's reasons have several.
    std::string
    in_one_line(const std::string &text)
    {
      std::istringstream words(text);
      std::string        line, word;
      while (words >> word)
        line += (line.empty() ? "" : " ") + word;
      return line;
    }

    std::string
    source_of(const ImportedMesh &mesh)
    {
      return mesh.file.empty()
               ? "the generator '" + mesh.generator + "' with the arguments '" +
                   mesh.arguments + "'"
               : "the file '" + mesh.file + "'";
    }
  } // namespace

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
        throw SceneError("Domain/Mesh: deal.II cannot make a " +
                         std::to_string(dim) + "D mesh from " +
                         source_of(mesh) + ": " + in_one_line(why.str()));
      }
  }

  namespace
  {
    /// Whether the cell is the image of the unit cell: turned the right way
    /// round at all its corners.
    template <typename Cell>
    bool
    is_convex(const Cell &cell)
    {
      constexpr int dim = Cell::AccessorType::dimension;
      using Info        = GeometryInfo<dim>;
      Point<dim>     vertices[Info::vertices_per_cell];
      Tensor<0, dim> volumes[Info::vertices_per_cell];
      for (const unsigned int v : Info::vertex_indices())
        vertices[v] = cell->vertex(v);
      Info::alternating_form_at_vertices(vertices, volumes);
      return std::all_of(std::begin(volumes),
                         std::end(volumes),
                         [](const double volume) { return volume > 0.; });
    }

    template <int dim>
    void
    check_cells(const ImportedMesh       &mesh,
                const Triangulation<dim> &triangulation)
    {
      if (!triangulation.all_reference_cells_are_hyper_cube())
        throw SceneError("Domain/Mesh: " + source_of(mesh) +
                         " has triangles, tetrahedra or other cells; allowed "
                         "are quadrilaterals (2D) and hexahedra (3D)");
      for (const auto &cell : triangulation.active_cell_iterators())
        if (!is_convex(cell))
          {
            std::ostringstream where;
            where << cell->center();
            throw SceneError("Domain/Mesh: " + source_of(mesh) +
                             " has distorted cells, for example at (" +
                             where.str() +
                             "): a corner has 180 degrees or more, or the "
                             "cell is inside out");
          }
    }
  } // namespace

  template <int dim>
  void
  fit_box(Domain<dim> &domain)
  {
    Triangulation<dim> coarse;
    make_coarse_mesh(*domain.mesh, coarse);
    check_cells(*domain.mesh, coarse);
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
