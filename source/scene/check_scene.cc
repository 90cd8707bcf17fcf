#include <selkie/base/exceptions.h>
#include <selkie/scene/check_scene.h>
#include <selkie/scene/declare_scene.h>
#include <selkie/scene/parameter_file.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// A point in the middle of a cell must reach more than the corners of
    /// that cell, else the minimisation for lambda is singular near walls
    /// (gamma = 6 with tolerance 1e-6 leaves the corners only).
    template <int dim>
    void
    check_lme(const Scene<dim> &scene)
    {
      const LmeParameters &lme = scene.lme;
      if (lme.gamma <= 0)
        fail(scene, "LME/Gamma", "it must be positive");
      const double support =
        std::sqrt(-std::log(lme.support_tolerance) / lme.gamma);
      const double next_nodes = std::sqrt((8. + dim) / 4.);
      if (support <= next_nodes)
        {
          std::ostringstream why;
          why << "with 'LME/Support tolerance' = " << lme.support_tolerance
              << " the support radius is " << support
              << " cells and leaves too few nodes to a point: from the middle "
                 "of a cell it reaches only the cell's corners. Allowed is a "
                 "radius sqrt(-ln(tolerance) / gamma) above "
              << next_nodes << ": gamma below "
              << -std::log(lme.support_tolerance) / next_nodes / next_nodes
              << " or a smaller tolerance";
          fail(scene, "LME/Gamma", why.str());
        }
    }


    template <int dim>
    void
    check_time(const Scene<dim> &scene)
    {
      const TimeParameters &time = scene.time;
      if (time.step <= 0)
        fail(scene, "Time/Step", "the time step must be positive");
      if (time.end_time <= 0)
        fail(scene, "Time/End time", "it must be positive");
      const double most_steps = std::numeric_limits<unsigned int>::max();
      if (time.end_time > most_steps * time.step)
        fail(scene,
             "Time/Step",
             "'Time/End time' is more than 4e9 such steps away, which the "
             "program does not count; allowed are longer steps");
      if (time.smallest_step > time.step)
        fail(scene,
             "Time/Smallest step",
             "it must not be larger than 'Time/Step'");
    }


    /// Conjugate gradients need a positive definite system.
    template <int dim>
    void
    check_solver(const Scene<dim> &scene)
    {
      const SolverKind kind = scene.linear_solver.kind;
      if (scene.has_pressure() &&
          (kind == SolverKind::cg_jacobi || kind == SolverKind::cg_ml ||
           kind == SolverKind::cg_hats))
        fail(scene,
             "Linear solver/Solver",
             "the scene has pressures, which make the system indefinite; "
             "allowed are 'automatic', 'gmres block', 'minres jacobi' and "
             "'direct'");
      if (kind == SolverKind::cg_hats &&
          scene.approximation != Approximation::lme_mpm)
        fail(scene,
             "Linear solver/Solver",
             "it is for 'Approximation' = 'lme mpm'; hat functions themselves "
             "have 'cg ml'");
    }


    template <int dim>
    bool
    is_held(const Scene<dim> &scene)
    {
      for (const auto &wall : scene.domain.walls)
        for (const bool held : wall.components)
          if (held)
            return true;
      return !scene.node_sets.empty();
    }


    template <int dim>
    void
    check_static(const Scene<dim> &scene)
    {
      if (!scene.inertia && !is_held(scene))
        fail(scene,
             "Effects",
             "a scene without inertia is static, and no boundary condition "
             "holds it: all walls are free and there is no node set. "
             "Allowed are a wall that is fixed, slip or prescribed, a node "
             "set, or the effect 'inertia'");
    }


    /// Looks without creating anything: results of earlier runs stay as they
    /// are.
    template <int dim>
    void
    check_output(const Scene<dim> &scene)
    {
      namespace fs           = std::filesystem;
      const std::string path = "Output/Directory";
      if (scene.output.directory.empty())
        fail(scene, path, "the name of a folder is needed");
      std::error_code error;
      fs::path        folder = fs::absolute(scene.output.directory, error);
      while (!fs::exists(folder, error) && folder.has_relative_path())
        {
          // An ancestor that is a file makes exists() fail with an error.
          folder = folder.parent_path();
        }
      if (!fs::is_directory(folder, error))
        fail(scene,
             path,
             "the output folder cannot be written: '" + folder.string() +
               "' is not a folder. Allowed is any folder that exists or can "
               "be made");
      if (access(folder.c_str(), W_OK | X_OK) != 0)
        fail(scene,
             path,
             "the output folder cannot be written: no permission to write in "
             "'" +
               folder.string() + "'");
    }
  } // namespace


  template <int dim>
  void
  fail(const Scene<dim> &scene, const std::string &path, const std::string &why)
  {
    const auto found = scene.parameters.find(path);
    if (found == scene.parameters.end())
      throw SceneError(scene.file + ": " + path + ": " + why);
    const ParameterValue &parameter = found->second;
    throw SceneError(parameter_message(parameter.origin.empty()
                                         ? scene.file
                                         : parameter.origin,
                                       path,
                                       parameter.value,
                                       why));
  }


  template <int dim>
  void
  check_walls(const Scene<dim>                 &scene,
              const std::string                &path,
              const std::array<bool, 2 * dim>  &walls,
              const std::vector<NodeCondition> &allowed)
  {
    const auto names = [](const NodeCondition condition) {
      return condition == NodeCondition::slip    ? "slip"
             : condition == NodeCondition::fixed ? "fixed"
                                                 : "prescribed";
    };
    std::string kinds;
    for (const NodeCondition condition : allowed)
      kinds += (kinds.empty() ? "" : " or ") + std::string(names(condition));
    const auto found = scene.parameters.find(path);
    const bool listed =
      found != scene.parameters.end() && !found->second.value.empty();
    bool any = false;
    for (unsigned int w = 0; w < 2 * dim; ++w)
      if (walls[w])
        {
          const bool good =
            std::find(allowed.begin(),
                      allowed.end(),
                      scene.domain.walls[w].condition) != allowed.end();
          if (listed && !good)
            fail(scene,
                 path,
                 "the wall '" + wall_names<dim>()[w] + "' is not " + kinds);
          any = any || good;
        }
    if (!any)
      fail(scene, path, "no wall of the scene is " + kinds);
  }


  template <int dim>
  void
  fail_without_need(const Scene<dim>  &scene,
                    const std::string &effect,
                    const std::string &path,
                    const std::string &nothing)
  {
    fail(scene,
         path,
         "the effect '" + effect + "' is listed with " + nothing +
           ": it would do nothing and cost " + find_effect(effect)->cost +
           ". Give it something to do, or remove it from 'Effects'");
  }


  template <int dim>
  double
  cell_size(const Domain<dim> &domain)
  {
    double h = std::numeric_limits<double>::max();
    for (unsigned int d = 0; d < dim; ++d)
      h = std::min(h, (domain.upper[d] - domain.lower[d]) / domain.cells[d]);
    return h;
  }


  template <int dim>
  void
  check_scene(const Scene<dim> &scene)
  {
    if (scene.approximation == Approximation::lme_mpm)
      check_lme(scene);
    check_time(scene);
    check_solver(scene);
    check_static(scene);
    check_geometry(scene);
    for (const auto &active : scene.effects)
      active.effect->check(scene);
    check_output(scene);
  }


  template void
  fail(const Scene<2> &, const std::string &, const std::string &);
  template void
  fail(const Scene<3> &, const std::string &, const std::string &);
  template void
  fail_without_need(const Scene<2> &,
                    const std::string &,
                    const std::string &,
                    const std::string &);
  template void
  fail_without_need(const Scene<3> &,
                    const std::string &,
                    const std::string &,
                    const std::string &);
  template double
  cell_size(const Domain<2> &);
  template double
  cell_size(const Domain<3> &);
  template void
  check_scene(const Scene<2> &);
  template void
  check_scene(const Scene<3> &);
  template void
  check_walls<2>(const Scene<2> &,
                 const std::string &,
                 const std::array<bool, 4> &,
                 const std::vector<NodeCondition> &);
  template void
  check_walls<3>(const Scene<3> &,
                 const std::string &,
                 const std::array<bool, 6> &,
                 const std::vector<NodeCondition> &);
} // namespace selkie
