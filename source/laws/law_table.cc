#include <selkie/laws/law_table.h>

namespace selkie
{
  const std::vector<LawRow> &
  law_table()
  {
    static const std::vector<LawRow> table = {
      neo_hookean_law(),
      isochoric_neo_hookean_law(),
      saint_venant_kirchhoff_law(),
      mooney_rivlin_law(),
      newtonian_fluid_law(),
      bingham_fluid_law(),
    };
    return table;
  }
} // namespace selkie
