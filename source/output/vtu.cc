#include <selkie/base/collective_error.h>
#include <selkie/base/exceptions.h>
#include <selkie/laws/hyperelastic_law.h>
#include <selkie/output/audit.h>
#include <selkie/output/files.h>
#include <selkie/output/vtu.h>

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/numerics/data_out.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>

namespace selkie
{
  namespace
  {
    using Interpretation =
      dealii::DataComponentInterpretation::DataComponentInterpretation;

    /// First and last component, name, interpretation: what deal.II asks for.
    using Range =
      std::tuple<unsigned int, unsigned int, std::string, Interpretation>;

    constexpr unsigned int digits = 4; ///< of the number in a file's name

    /// By size: what is neither scalar nor vector is a tensor.
    Interpretation
    interpretation(const unsigned int n_components, const unsigned int dim)
    {
      if (n_components == 1)
        return dealii::DataComponentInterpretation::component_is_scalar;
      if (n_components == dim)
        return dealii::DataComponentInterpretation::component_is_part_of_vector;
      return dealii::DataComponentInterpretation::component_is_part_of_tensor;
    }

    /// Compressed fast: files hardly larger, written several times faster.
    dealii::DataOutBase::VtkFlags
    vtk_flags(const double                              time,
              const unsigned int                        step,
              const std::map<std::string, std::string> &units = {})
    {
      dealii::DataOutBase::VtkFlags flags(time, step);
      flags.compression_level = dealii::DataOutBase::VtkFlags::best_speed;
      flags.physical_units    = units;
      return flags;
    }

    /// The Cauchy stress of a point; NaN if it is inverted.
    template <int dim>
    Tensor<2, 3>
    cauchy_stress(const ParticleSet<dim>                &particles,
                  const dealii::ArrayView<const double> &properties)
    {
      const auto &columns = particles.columns;
      const auto &body =
        particles.scene
          .bodies[static_cast<unsigned int>(columns.body(properties))];
      if (body.law->phase() == Phase::fluid)
        return -columns.pressure(properties) * identity();

      const Tensor<2, 3> F = extend(columns.F(properties));
      const double       J = dealii::determinant(F);
      if (!(J > 0.))
        return std::numeric_limits<double>::quiet_NaN() * identity();
      const auto        &law = dynamic_cast<const HyperelasticLaw &>(*body.law);
      const Tensor<2, 3> b   = left_cauchy_green(F);
      return kirchhoff_stress(law.response(invariants(b, J)), b) / J;
    }


    /// Material points as deal.II's output understands them: patches of one
    /// vertex, with the values of all fields in one column.
    template <int dim>
    class ParticlePatches : public dealii::DataOutInterface<0, dim>
    {
    public:
      explicit ParticlePatches(const ParticleSet<dim> &particles);

      std::map<std::string, std::string> units;

    private:
      using Patch = dealii::DataOutBase::Patch<0, dim>;
      using Point = dealii::Particles::ParticleAccessor<dim>;

      /// Writes the components of a field at a point.
      using Compute = std::function<void(const Point &, double *)>;

      void
      declare(const std::string &name,
              const std::string &unit,
              const unsigned int n_components,
              const Compute     &compute);

      void
      declare_columns(const ParticleSet<dim> &particles);

      void
      declare_computed(const ParticleSet<dim> &particles);

      const std::vector<Patch> &
      get_patches() const override
      {
        return patches;
      }

      std::vector<std::string>
      get_dataset_names() const override
      {
        return names;
      }

      std::vector<Range>
      get_nonscalar_data_ranges() const override
      {
        return ranges;
      }

      std::vector<Compute>      computes;
      std::vector<unsigned int> offsets; ///< of the fields, in components
      std::vector<std::string>  names;   ///< of the components
      std::vector<Range>        ranges;
      std::vector<Patch>        patches;
    };


    template <int dim>
    ParticlePatches<dim>::ParticlePatches(const ParticleSet<dim> &particles)
    {
      declare_columns(particles);
      declare_computed(particles);

      std::vector<double> values(names.size());
      for (const auto &point : particles.handler())
        {
          for (unsigned int f = 0; f < computes.size(); ++f)
            computes[f](point, &values[offsets[f]]);
          Patch patch;
          patch.vertices[0] = point.get_location();
          patch.patch_index = patches.size();
          patch.data.reinit(values.size(), 1);
          for (unsigned int i = 0; i < values.size(); ++i)
            patch.data(i, 0) = values[i];
          patches.push_back(patch);
        }
    }


    template <int dim>
    void
    ParticlePatches<dim>::declare(const std::string &name,
                                  const std::string &unit,
                                  const unsigned int n_components,
                                  const Compute     &compute)
    {
      const unsigned int first = names.size();
      offsets.push_back(first);
      computes.push_back(compute);
      for (unsigned int i = 0; i < n_components; ++i)
        names.push_back(n_components == 1 ? name
                                          : name + '_' + std::to_string(i));
      if (n_components > 1)
        ranges.emplace_back(first,
                            first + n_components - 1,
                            name,
                            interpretation(n_components, dim));
      if (!unit.empty())
        units[name] = unit;
    }


    template <int dim>
    void
    ParticlePatches<dim>::declare_columns(const ParticleSet<dim> &particles)
    {
      for (const ParticleFields::Entry &entry : particles.fields.entries())
        if (entry.output && entry.offset != particles.columns.J.offset)
          declare(entry.name,
                  entry.unit,
                  entry.n_components,
                  [entry](const Point &point, double *values) {
                    const auto properties = point.get_properties();
                    std::copy_n(properties.data() + entry.offset,
                                entry.n_components,
                                values);
                  });
    }


    template <int dim>
    void
    ParticlePatches<dim>::declare_computed(const ParticleSet<dim> &particles)
    {
      const auto &columns = particles.columns;
      declare("id", "", 1, [](const Point &point, double *id) {
        *id = point.get_id();
      });
      declare("volume ratio", "", 1, [&](const Point &point, double *J) {
        *J = volume_ratio(particles, point.get_properties());
      });
      if (columns.X.exists())
        declare("displacement", "m", dim, [&](const Point &point, double *u) {
          const auto X = columns.X(point.get_properties());
          for (unsigned int i = 0; i < dim; ++i)
            u[i] = point.get_location()[i] - X[i];
        });
      if (columns.F.exists())
        declare("Cauchy stress", "Pa", 9, [&](const Point &point, double *s) {
          const auto stress = cauchy_stress(particles, point.get_properties());
          std::copy_n(stress.begin_raw(), 9, s);
        });
    }


    /// The nodes of one layer, numbered as if there were no other.
    template <int dim>
    class Layer
    {
    public:
      Layer(const NodeCloud<dim> &cloud, const unsigned int layer)
        : dofs(cloud.dof_handler().get_triangulation())
        , n_layers(cloud.n_layers())
        , layer(layer)
      {
        dofs.distribute_dofs(dealii::FE_Q<dim>(1));
        dealii::DoFTools::extract_locally_relevant_dofs(dofs, relevant);
      }

      typename NodalOutput<dim>::Field
      part_of(const typename NodalOutput<dim>::Field &all) const
      {
        typename NodalOutput<dim>::Field part(dofs.locally_owned_dofs(),
                                              relevant,
                                              all.get_mpi_communicator());
        for (unsigned int i = 0; i < part.locally_owned_size(); ++i)
          part.local_element(i) = all.local_element(i * n_layers + layer);
        part.update_ghost_values();
        return part;
      }

      dealii::DoFHandler<dim> dofs;

    private:
      const unsigned int n_layers, layer;
      dealii::IndexSet   relevant;
    };


    /// deal.II's DataOut, with several scalar fields shown as one vector, and a
    /// set of fields for each layer of nodes.
    template <int dim>
    class NodalPatches : public dealii::DataOut<dim>
    {
    public:
      explicit NodalPatches(const NodalOutput<dim> &output)
      {
        const NodeCloud<dim> &cloud = *output.cloud;
        if (cloud.n_layers() == 1)
          add(
            output, cloud.dof_handler(), "", [](const auto &all) -> auto & {
              return all;
            });
        std::vector<std::unique_ptr<const Layer<dim>>> layers;
        for (unsigned int l = 0; cloud.n_layers() > 1 && l < cloud.n_layers();
             ++l)
          {
            layers.push_back(std::make_unique<const Layer<dim>>(cloud, l));
            add(output,
                layers[l]->dofs,
                "_of_layer_" + std::to_string(l),
                [&](const auto &all) { return layers[l]->part_of(all); });
          }
        this->build_patches();
        this->clear_input_data_references(); // of the layers
      }

    private:
      /// @param part_of the field of these nodes, of a whole one
      template <typename PartOf>
      void
      add(const NodalOutput<dim>        &output,
          const dealii::DoFHandler<dim> &dofs,
          const std::string             &which,
          const PartOf                  &part_of)
      {
        for (const auto &[name, values] : output.vectors)
          {
            for (unsigned int i = 0; i < dim; ++i)
              this->add_data_vector(dofs,
                                    part_of(values[i]),
                                    name + which + '_' + std::to_string(i));
            ranges.emplace_back(n_fields,
                                n_fields + dim - 1,
                                name + which,
                                interpretation(dim, dim));
            n_fields += dim;
          }
        for (const auto &[name, values] : output.scalars)
          {
            this->add_data_vector(dofs, part_of(values), name + which);
            ++n_fields;
          }
      }

      std::vector<Range>
      get_nonscalar_data_ranges() const override
      {
        return ranges;
      }

      unsigned int       n_fields = 0; ///< so far
      std::vector<Range> ranges;
    };


    /// One .vtu a rank and the .pvtu that lists them, with deal.II's names
    /// (write_vtu_with_pvtu_record()). Collective. Returns the .pvtu's name.
    /// @throw OutputError, on all ranks, if a file cannot be written.
    template <typename Patches>
    std::string
    write_pieces(const Patches     &patches,
                 const std::string &folder,
                 const std::string &name,
                 const unsigned int number,
                 const MPI_Comm     comm)
    {
      using dealii::Utilities::int_to_string;
      const std::string  stem = name + '_' + int_to_string(number, digits);
      const unsigned int n_ranks =
        dealii::Utilities::MPI::n_mpi_processes(comm);
      const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(comm);
      std::vector<std::string> pieces;
      for (unsigned int r = 0; r < n_ranks; ++r)
        pieces.push_back(
          stem + '.' +
          int_to_string(r, dealii::Utilities::needed_digits(n_ranks - 1)) +
          ".vtu");
      fail_together<OutputError>(comm, [&] {
        write_file(folder + pieces[rank],
                   [&](std::ostream &file) { patches.write_vtu(file); });
        if (rank == 0)
          write_file(folder + stem + ".pvtu", [&](std::ostream &file) {
            patches.write_pvtu_record(file, pieces);
          });
      });
      return stem + ".pvtu";
    }
  } // namespace


  template <int dim>
  VtuWriter<dim>::VtuWriter(const std::string      &directory,
                            const ParticleSet<dim> &particles)
    : directory(directory)
    , particles(particles)
  {}


  template <int dim>
  void
  VtuWriter<dim>::write(const double            time,
                        const unsigned int      step,
                        const NodalOutput<dim> *mesh)
  {
    write_particles(time, step);
    if (mesh)
      write_mesh(time, step, *mesh);
  }


  template <int dim>
  void
  VtuWriter<dim>::write_particles(const double time, const unsigned int step)
  {
    ParticlePatches<dim> patches(particles);
    patches.set_flags(vtk_flags(time, step, patches.units));
    const std::string file = write_pieces(patches,
                                          directory + "/solution/",
                                          "particles",
                                          particle_files.size(),
                                          particles.communicator());
    add_to_record("particles", time, file, particle_files);
  }


  template <int dim>
  void
  VtuWriter<dim>::write_mesh(const double            time,
                             const unsigned int      step,
                             const NodalOutput<dim> &mesh)
  {
    NodalPatches<dim> patches(mesh);
    patches.set_flags(vtk_flags(time, step));
    const std::string file = write_pieces(patches,
                                          directory + "/solution/",
                                          "mesh",
                                          mesh_files.size(),
                                          particles.communicator());
    add_to_record("mesh", time, file, mesh_files);
  }


  template <int dim>
  void
  VtuWriter<dim>::add_to_record(const std::string &name,
                                const double       time,
                                const std::string &file,
                                Record            &record) const
  {
    record.emplace_back(time, "solution/" + file);
    const MPI_Comm comm = particles.communicator();
    fail_together<OutputError>(comm, [&] {
      if (dealii::Utilities::MPI::this_mpi_process(comm) != 0)
        return;
      // Written aside and renamed: a viewer never meets half a list.
      const std::string path = directory + '/' + name + ".pvd";
      write_file(path + ".new", [&](std::ostream &pvd) {
        dealii::DataOutBase::write_pvd_record(pvd, record);
      });
      std::filesystem::rename(path + ".new", path);
    });
  }


  template class VtuWriter<2>;
  template class VtuWriter<3>;
} // namespace selkie
