#pragma once

#include <selkie/mesh/node_cloud.h>
#include <selkie/particles/particle_set.h>

#include <deal.II/lac/la_parallel_vector.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace selkie
{
  /// Nodal fields to be written on the background mesh, in the numbering of
  /// the cloud, with ghost values up to date.
  template <int dim>
  struct NodalOutput
  {
    using Field = dealii::LinearAlgebra::distributed::Vector<double>;

    const NodeCloud<dim>                                       *cloud = nullptr;
    std::vector<std::pair<std::string, Field>>                  scalars;
    std::vector<std::pair<std::string, std::array<Field, dim>>> vectors;
  };

  /**
   * Pictures for ParaView: particles.pvd and mesh.pvd, and the files that they
   * list, in solution/. The lists are complete after each write.
   *
   * Particles carry the columns registered for output and, computed here,
   * id, displacement (with a reference position), volume ratio and, with a
   * solid, the Cauchy stress as 3x3 tensor (a fluid's is -p I).
   */
  template <int dim>
  class VtuWriter
  {
  public:
    /// The folder `directory`/solution exists.
    VtuWriter(const std::string &directory, const ParticleSet<dim> &particles);

    /// Collective.
    /// @throw OutputError, on all ranks, if a file cannot be written.
    /// @param time s
    /// @param step number of steps done, written as VTK's CYCLE
    /// @param mesh null: particles only
    void
    write(const double            time,
          const unsigned int      step,
          const NodalOutput<dim> *mesh);

    /// Time and file of the pictures so far.
    using Record = std::vector<std::pair<double, std::string>>;

    const Record &
    particle_pictures() const
    {
      return particle_files;
    }

    const Record &
    mesh_pictures() const
    {
      return mesh_files;
    }

    /// Goes on after these.
    void
    restore(const Record &particle_pictures, const Record &mesh_pictures)
    {
      particle_files = particle_pictures;
      mesh_files     = mesh_pictures;
    }

  private:
    void
    write_particles(const double time, const unsigned int step);

    void
    write_mesh(const double            time,
               const unsigned int      step,
               const NodalOutput<dim> &mesh);

    /// Adds a file to `name`.pvd.
    void
    add_to_record(const std::string &name,
                  const double       time,
                  const std::string &file,
                  Record            &record) const;

    const std::string       directory;
    const ParticleSet<dim> &particles;
    Record                  particle_files, mesh_files; ///< time, file
  };
} // namespace selkie
