#pragma once

#include <selkie/assembly/assembler.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/mesh/node_cloud.h>
#include <selkie/particles/particle_set.h>
#include <selkie/shape/contact_pairs.h>
#include <selkie/shape/lme_support.h>
#include <selkie/shape/occupancy.h>
#include <selkie/terms/effect_table.h>
#include <selkie/transfer/transfer.h>

#include <memory>
#include <string>
#include <vector>

#include "../small_scenes.h"

/// A scene with its supports: everything before the assembly.
template <int dim>
struct AssembledScene
{
  explicit AssembledScene(const std::string              &text,
                          const std::vector<std::string> &overrides = {},
                          const selkie::Newmark &newmark = {0.25, 0.5, 1e-3})
    : time{0., newmark}
    , scene(small_scenes::read<dim>(text, overrides))
    , mesh(selkie::make_background_mesh<dim>(scene.domain, MPI_COMM_WORLD))
    , particles(scene, *mesh)
  {
    using namespace selkie;
    particles.seed();
    cloud                = std::make_unique<NodeCloud<dim>>(*mesh,
                                             scene.lme.gamma,
                                             scene.lme.support_tolerance,
                                             scene.n_layers());
    conditions           = std::make_unique<NodeConditions<dim>>(scene, *cloud);
    system               = std::make_unique<System<dim>>(*cloud,
                                           *conditions,
                                           scene.pressure_phases());
    terms                = terms_of(scene);
    assembler            = std::make_unique<Assembler<dim>>(terms, *system);
    auto       stored    = no_pressures(scene, *cloud);
    const auto occupancy = find_occupancy(particles, *cloud, scene.has_fluid());
    fill_material_points(particles, *cloud, occupancy, table);
    if (scene.contact)
      add_contact_pairs(*cloud, occupancy, table);
    system->reinit(occupancy, table);
    project(particles,
            table,
            *system,
            0.,
            time.newmark.dt,
            stored,
            static_cast<const NodalState<dim> *>(nullptr),
            fields);
    if (scene.has_fluid())
      {
        store_pressures(*system, fields, stored);
        GaussSupports<dim> known;
        add_gauss_points(*cloud, stored.at(0), known, table);
      }
    if (scene.wall_points)
      add_wall_points(*cloud, *scene.wall_points, table);
    system->initialize(residual);
  }

  /// The residual, and the tangent if asked for.
  void
  assemble(const bool with_tangent, const double pressure_unit = 1.)
  {
    assembler->assemble(
      table, time, fields, pressure_unit, with_tangent, residual);
  }

  const selkie::StepTime                                   time;
  selkie::Scene<dim>                                       scene;
  std::unique_ptr<typename selkie::ParticleSet<dim>::Mesh> mesh;
  selkie::ParticleSet<dim>                                 particles;
  std::unique_ptr<selkie::NodeCloud<dim>>                  cloud;
  std::unique_ptr<selkie::NodeConditions<dim>>             conditions;
  std::unique_ptr<selkie::System<dim>>                     system;
  std::vector<std::shared_ptr<const selkie::Term<dim>>>    terms;
  std::unique_ptr<selkie::Assembler<dim>>                  assembler;
  selkie::SupportTable<dim>                                table;
  selkie::StepFields                                       fields;
  selkie::Vector                                           residual;
};
