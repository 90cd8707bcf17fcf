#include <selkie/scene/declare_scene.h>
#include <selkie/scene/effect.h>

#include <algorithm>

namespace selkie
{
  const EffectRow *
  find_effect(const std::string &name)
  {
    for (const EffectRow &row : effect_table())
      if (row.name == name)
        return &row;
    return nullptr;
  }


  std::string
  listed_effects(const std::string &separator)
  {
    std::string names;
    for (const EffectRow &row : effect_table())
      if (row.comes_with == nullptr)
        names += (names.empty() ? "" : separator) + row.name;
    return names;
  }


  std::vector<const EffectRow *>
  effects_of(const SceneNames &names)
  {
    std::vector<const EffectRow *> rows;
    for (const EffectRow &row : effect_table())
      if (names.has_effect(row.name) ||
          (row.comes_with != nullptr && row.comes_with(names)))
        rows.push_back(&row);
    std::vector<const EffectRow *> kept;
    for (const EffectRow *row : rows)
      if (std::none_of(rows.begin(), rows.end(), [row](const EffectRow *other) {
            return other->replaces == row->name;
          }))
        kept.push_back(row);
    return kept;
  }
} // namespace selkie
