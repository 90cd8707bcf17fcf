/**
 * @file
 * How should a scene's terms be called? A list of terms, each a virtual call
 * for a patch, against a pack composed at compile time, one loop over the
 * points for all of them; and what a patch costs in all. Figures and decision:
 * doc/design-notes.md, section 1.
 */
#include <selkie/assembly/assembler.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/mesh/node_cloud.h>
#include <selkie/particles/particle_set.h>
#include <selkie/shape/lme_support.h>
#include <selkie/shape/occupancy.h>
#include <selkie/terms/effect_table.h>
#include <selkie/transfer/transfer.h>

#include <deal.II/base/mpi.h>

#include <benchmark/benchmark.h>

#include "../small_scenes.h"

using namespace selkie;

namespace
{
  /// A cheap term, so that the call weighs as much as it can.
  template <int dim>
  class Weight : public Term<dim>
  {
  public:
    explicit Weight(const double g)
    {
      acceleration[1] = g;
    }

    std::string
    name() const override
    {
      return "weight";
    }

    TermUse
    use() const override
    {
      TermUse use;
      use.source = true;
      return use;
    }

    bool
    acts_on(const PatchKind &kind) const override
    {
      return kind.matter;
    }

    void
    add(PatchState<dim> &state, const bool) const override
    {
      for (unsigned int q = 0; q < state.patch->n_points; ++q)
        add_point(state, q);
    }

    void
    add_point(PatchState<dim> &state, const unsigned int q) const
    {
      state.forms[q].source -= state.point(q).mass * acceleration;
    }

  private:
    dealii::Tensor<1, dim> acceleration;
  };

  /// Three of them in one loop, known to the compiler.
  template <int dim>
  struct Pack
  {
    Weight<dim> a{1.}, b{2.}, c{3.};

    void
    add(PatchState<dim> &state) const
    {
      for (unsigned int q = 0; q < state.patch->n_points; ++q)
        {
          a.add_point(state, q);
          b.add_point(state, q);
          c.add_point(state, q);
        }
    }
  };

  /// A block of rubber with its supports: everything before the assembly.
  struct Block
  {
    Block()
      : scene(small_scenes::read<2>(small_scenes::free_block()))
      , mesh(make_background_mesh<2>(scene.domain, MPI_COMM_WORLD))
      , particles(scene, *mesh)
    {
      particles.seed();
      cloud      = std::make_unique<NodeCloud<2>>(*mesh,
                                             scene.lme.gamma,
                                             scene.lme.support_tolerance);
      conditions = std::make_unique<NodeConditions<2>>(scene, *cloud);
      system     = std::make_unique<System<2>>(*cloud, *conditions, false);
      terms      = terms_of(scene);
      assembler  = std::make_unique<Assembler<2>>(terms, *system);
      const auto occupancy = find_occupancy(particles, *cloud, false);
      fill_material_points(particles, *cloud, occupancy, table);
      system->reinit(occupancy, table);
      project(particles,
              table,
              *system,
              0.,
              dt,
              Vector(),
              static_cast<const NodalState<2> *>(nullptr),
              fields);
    }

    static constexpr double                     dt = 1e-3;
    Scene<2>                                    scene;
    std::unique_ptr<ParticleSet<2>::Mesh>       mesh;
    ParticleSet<2>                              particles;
    std::unique_ptr<NodeCloud<2>>               cloud;
    std::unique_ptr<NodeConditions<2>>          conditions;
    std::unique_ptr<System<2>>                  system;
    std::vector<std::shared_ptr<const Term<2>>> terms;
    std::unique_ptr<Assembler<2>>               assembler;
    SupportTable<2>                             table;
    StepFields                                  fields;
    const StepTime time{0., Newmark(0.25, 0.5, dt)};
  };

  /// Calls run(state) for every patch.
  template <typename Run>
  void
  for_patches(benchmark::State &state, const Run &run)
  {
    Block         block;
    PatchState<2> patch_state;
    patch_state.table = &block.table;
    patch_state.forms.resize(64);
    for (auto _ : state)
      for (const auto &patch : block.table.patches)
        {
          patch_state.patch = &patch;
          run(patch_state);
          benchmark::DoNotOptimize(patch_state.forms[0].source);
        }
    state.SetItemsProcessed(state.iterations() * block.table.patches.size());
  }

  void
  list_of_terms(benchmark::State &state)
  {
    std::vector<std::shared_ptr<const Term<2>>> terms;
    for (const double g : {1., 2., 3.})
      terms.push_back(std::make_shared<Weight<2>>(g));
    for_patches(state, [&](PatchState<2> &patch_state) {
      for (const auto &term : terms)
        term->add(patch_state, false);
    });
  }

  void
  pack_of_terms(benchmark::State &state)
  {
    const Pack<2> pack;
    for_patches(state,
                [&](PatchState<2> &patch_state) { pack.add(patch_state); });
  }

  void
  whole_assembly(benchmark::State &state, const bool with_tangent)
  {
    Block  block;
    Vector residual;
    block.system->initialize(residual);
    for (auto _ : state)
      block.assembler->assemble(
        block.table, block.time, block.fields, 1., with_tangent, residual);
    state.SetItemsProcessed(state.iterations() * block.table.patches.size());
  }

  /// What the sampled costs of five parts add to a patch.
  void
  ledger_of_a_patch(benchmark::State &state)
  {
    CostLedger ledger({"a", "b", "c", "d", "e"});
    for (auto _ : state)
      if (ledger.begin_pass())
        for (unsigned int part = 0; part < 5; ++part)
          ledger.book(part);
    state.SetItemsProcessed(state.iterations());
  }

  void
  residual_of_a_patch(benchmark::State &state)
  {
    whole_assembly(state, false);
  }

  void
  tangent_of_a_patch(benchmark::State &state)
  {
    whole_assembly(state, true);
  }
} // namespace

BENCHMARK(list_of_terms);
BENCHMARK(pack_of_terms);
BENCHMARK(ledger_of_a_patch);
BENCHMARK(residual_of_a_patch);
BENCHMARK(tangent_of_a_patch);

int
main(int argc, char **argv)
{
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
