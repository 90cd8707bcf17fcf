#include <selkie/terms/effect_table.h>

namespace selkie
{
  template <int dim>
  std::vector<std::shared_ptr<const Term<dim>>>
  terms_of(const Scene<dim> &scene)
  {
    std::vector<std::shared_ptr<const Term<dim>>> terms;
    for (const auto &active : scene.effects)
      if (auto term = active.effect->term(scene))
        terms.push_back(std::move(term));
    return terms;
  }

  template std::vector<std::shared_ptr<const Term<2>>>
  terms_of(const Scene<2> &);
  template std::vector<std::shared_ptr<const Term<3>>>
  terms_of(const Scene<3> &);
} // namespace selkie
