#include <selkie/laws/law_table.h>
#include <selkie/terms/effect_table.h>

/**
 * @file
 * The tables of a program in which only one law, inertia, the elasticity that
 * comes with solids and the audit, which gives the digits to compare, exist. It
 * is linked without the sources of all the others: that it links proves that
 * nothing else knows them, and what it counts is what the bare scene should
 * cost.
 */
namespace selkie
{
  const std::vector<EffectRow> &
  effect_table()
  {
    static const std::vector<EffectRow> table = {inertia_effect(),
                                                 elasticity_effect(),
                                                 audit_effect()};
    return table;
  }


  const std::vector<LawRow> &
  law_table()
  {
    static const std::vector<LawRow> table = {neo_hookean_law()};
    return table;
  }
} // namespace selkie
