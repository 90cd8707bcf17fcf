#pragma once

#include <deal.II/base/parameter_handler.h>

#include <memory>
#include <string>
#include <vector>

namespace selkie
{
  struct ParameterEntry;
  struct SceneNames;
  template <int dim>
  struct Scene;
  class ParticleFields;
  template <int dim>
  class ParticleSet;
  template <int dim>
  class Term;
  template <int dim>
  class Recorder;
  template <int dim>
  class NodeCloud;
  template <int dim>
  class NodeConditions;

  /**
   * One thing that a scene asks for by name, whole: its parameters, its
   * checks, the particle columns that it needs, its kernel and its output. An
   * effect is one source file and one row of effect_table(). One that the
   * scene does not ask for is never made.
   *
   * Parameters that only the effect itself reads are its members; those that
   * other parts of the program read as well (the acceleration of gravity, in
   * the energy balance) are members of Scene.
   */
  template <int dim>
  class Effect
  {
  public:
    virtual ~Effect() = default;

    /// Declares the parameters of the effect in the current subsection, tied
    /// to members of the effect or of the scene.
    virtual void
    declare(dealii::ParameterHandler & /*prm*/,
            const SceneNames & /*names*/,
            Scene<dim> & /*scene*/)
    {}

    /// @throw SceneError for what contradicts the rest of the scene.
    virtual void
    check(const Scene<dim> & /*scene*/) const
    {}

    /// Registers the particle columns that its kernel needs.
    virtual void
    add_columns(const Scene<dim> & /*scene*/, ParticleFields & /*fields*/) const
    {}

    /// Prescribes displacement components of nodes as they are at time @p t
    /// (s). Local; called at the start and again while something moves.
    virtual void
    hold(const Scene<dim> & /*scene*/,
         const NodeCloud<dim> & /*cloud*/,
         const double /*t*/,
         NodeConditions<dim> & /*conditions*/) const
    {}

    /// Acts once on the seeded points.
    virtual void
    start(ParticleSet<dim> & /*particles*/) const
    {}

    /// Its part of the weak form; null if it has none.
    virtual std::shared_ptr<const Term<dim>>
    term(const Scene<dim> & /*scene*/) const
    {
      return nullptr;
    }

    /// What it writes besides the statistics; null if nothing. Collective.
    virtual std::shared_ptr<Recorder<dim>>
    recorder(const ParticleSet<dim> & /*particles*/) const
    {
      return nullptr;
    }
  };


  /// How a scene names an effect, and how it is made.
  struct EffectRow
  {
    std::string name;
    std::string section; ///< its subsection, or "" if it has none
    std::string documentation;

    /// What it costs, for those who list it without need: relative to a scene
    /// without it, measured by tests/performance/effects.
    std::string cost;

    std::shared_ptr<Effect<2>> (*make_2d)();
    std::shared_ptr<Effect<3>> (*make_3d)();

    /// Whether a scene with these names has the effect without listing it
    /// (a fluid has a pressure, a slip wall holds nodes); null: never.
    bool (*comes_with)(const SceneNames &names) = nullptr;

    /// The effect that is left out in favour of this one, or "".
    std::string replaces = "";

    /// Whether a parameter elsewhere has a meaning with this effect only (the
    /// viscosity of a law); null: none has.
    bool (*claims)(const ParameterEntry &entry) = nullptr;

    template <int dim>
    std::shared_ptr<Effect<dim>>
    make() const
    {
      if constexpr (dim == 2)
        return make_2d();
      else
        return make_3d();
    }
  };


  /// A row for the effects EffectOf<2> and EffectOf<3>.
  template <template <int> class EffectOf>
  EffectRow
  effect_row(const std::string &name,
             const std::string &section,
             const std::string &documentation,
             const std::string &cost)
  {
    EffectRow row;
    row.name          = name;
    row.section       = section;
    row.documentation = documentation;
    row.cost          = cost;
    row.make_2d       = []() -> std::shared_ptr<Effect<2>> {
      return std::make_shared<EffectOf<2>>();
    };
    row.make_3d = []() -> std::shared_ptr<Effect<3>> {
      return std::make_shared<EffectOf<3>>();
    };
    return row;
  }


  /// All effects, in the order of the parameter reference, of the terms and of
  /// the checks. Defined in terms/effect_table.cc, where a new effect gets its
  /// row.
  const std::vector<EffectRow> &
  effect_table();

  /// The row of the effect called @p name; nullptr if there is none.
  const EffectRow *
  find_effect(const std::string &name);

  /// The names of the effects that a scene can list, joined by @p separator.
  std::string
  listed_effects(const std::string &separator);

  /// The effects of a scene with these names, in the table's order: those that
  /// it lists and those that come with its bodies, less the replaced ones.
  std::vector<const EffectRow *>
  effects_of(const SceneNames &names);


  /// An effect of a scene.
  template <int dim>
  struct ActiveEffect
  {
    std::string                        name;
    std::shared_ptr<const Effect<dim>> effect;
  };
} // namespace selkie
