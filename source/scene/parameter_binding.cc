#include <selkie/base/exceptions.h>
#include <selkie/scene/parameter_binding.h>

namespace selkie
{
  using namespace dealii;

  unsigned int
  index_of(const std::string              &text,
           const std::vector<std::string> &names,
           const std::string              &what)
  {
    std::string known;
    for (unsigned int i = 0; i < names.size(); ++i)
      {
        if (names[i] == text)
          return i;
        known += (known.empty() ? "" : ", ") + names[i];
      }
    throw SceneError("there is no such " + what + "; allowed are: " + known);
  }


  void
  add_index(ParameterHandler               &prm,
            const std::string              &name,
            unsigned int                   &variable,
            const std::vector<std::string> &names,
            const std::string              &what,
            const std::string              &documentation)
  {
    prm.declare_entry(name,
                      names.empty() ? "" : names[0],
                      Patterns::Anything(),
                      documentation);
    prm.add_action(name, [&variable, names, what](const std::string &text) {
      if (!text.empty() || !names.empty())
        variable = index_of(text, names, what);
    });
  }
} // namespace selkie
