#pragma once

#include <selkie/scene/scene.h>

#include <string>
#include <vector>

namespace selkie
{
  /// The entry `Dimension` of a scene file.
  /// @param overrides "Section/Subsection/Name=value" each, stronger than the
  /// file
  /// @throw SceneError if the file cannot be read or says something else than
  /// 2 or 3.
  unsigned int
  read_dimension(const std::string              &file,
                 const std::vector<std::string> &overrides = {});

  /**
   * Reads and checks a scene. First the names of its parts are read, then the
   * parameters that a scene with these parts has are declared and given their
   * values, then check_scene() looks at the whole.
   * @throw SceneError in one line that names file, parameter, value and what
   * is allowed.
   */
  template <int dim>
  Scene<dim>
  read_scene(const std::string              &file,
             const std::vector<std::string> &overrides = {});

  /// The reference of all parameters, as Markdown or as a commented .prm;
  /// `<body>` and the like stand for the names that a scene gives.
  std::string
  parameter_reference(const bool markdown);
} // namespace selkie
