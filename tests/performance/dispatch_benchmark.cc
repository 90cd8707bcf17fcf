/**
 * @file
 * How should a scene's terms be called? A list of terms, each a virtual call
 * for a patch, against a pack composed at compile time, one loop over the
 * points for all of them; and what a patch costs in all. Figures and decision:
 * doc/design-notes.md, section 1.
 */
#include <deal.II/base/mpi.h>

#include <benchmark/benchmark.h>

#include "assembled_scene.h"

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

  /// Calls run(state) for every patch.
  template <typename Run>
  void
  for_patches(benchmark::State &state, const Run &run)
  {
    AssembledScene<2> block(small_scenes::free_block());
    PatchState<2>     patch_state;
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
    AssembledScene<2> block(small_scenes::free_block());
    for (auto _ : state)
      block.assemble(with_tangent);
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
