#pragma once

#include <selkie/output/recorder.h>
#include <selkie/output/statistics.h>
#include <selkie/particles/particle_set.h>

#include <string>
#include <vector>

namespace selkie
{
  /**
   * The scene's probes: one file probes/NAME.csv each, a row per record().
   *
   * - `point`: mean displacement, position, velocity and, of those that have
   *   one, pressure of the points whose reference position is within the radius
   *   of the probe's position; when there is none, of those nearest to it.
   * - `region`: the same for the points that started inside a shape.
   * - `node`: the same of the node nearest to the probe's position at the start
   *   (with a Lagrangian mesh).
   * - `wall force`: the force on a wall and its moment about a position.
   * - `wall pressure`: the mean of the fluid's pressure over a rectangle on a
   *   wall, dry parts counted with zero; the largest; the share that is wet.
   *   The pressure is that of the nodes, linear between them.
   * - `height`: how far a body reaches along an axis, near a line.
   * - `body force`: sum of m (a - g) over a body's points, which is the force
   *   of its surroundings on it, and its moment about a position.
   * - `front`: largest and smallest coordinate of a body's points along an
   *   axis. The matter reaches about half a point spacing further.
   * - `extent`: smallest and largest coordinates of a body's points, its
   *   volume, centre of mass, and along each axis the semi-axis of the
   *   homogeneous ellipse (ellipsoid) of the same second moment.
   * - `error`: how far displacement or velocity of a body's points are from a
   *   function of X and t: L2 norm of the difference, largest difference, L2
   *   norm of the function. The norms are root mean squares weighted with the
   *   points' reference volumes: L2 over the body, over sqrt(its volume).
   *
   * Points are found anew by their reference position at each record: nothing
   * has to follow them through migration or a restart.
   */
  template <int dim>
  class Probes : public Recorder<dim>
  {
  public:
    /// Collective; call when the points are seeded. The folder
    /// `directory`/probes exists.
    /// @param interval time between two rows (s)
    Probes(const Scene<dim>       &scene,
           const ParticleSet<dim> &particles,
           const std::string      &directory,
           const double            interval = 0.);

    std::string
    name() const override
    {
      return "probes";
    }

    double
    interval() const override
    {
      return seconds;
    }

    /// Adds a row to each file. Collective.
    void
    record(const double           time,
           const WallForces<dim> &walls,
           const NodeMotion<dim> &nodes = NodeMotion<dim>()) override;

  private:
    struct Curve
    {
      const Probe<dim> *probe;
      double            radius = 0; ///< of a point probe; reaches a point
      bool              with_pressure = false; ///< has that column
      Statistics        table;
    };

    /// What is summed over the points of a probe.
    struct Sums
    {
      double weight = 0, mass = 0, volume = 0;
      double wet = 0, pressure = 0;   ///< weight of points with one
      dealii::Tensor<1, dim> x, u, v; ///< position, displacement, velocity
      dealii::Tensor<1, dim> mx, mxx; ///< first and second moments of mass
      dealii::Tensor<1, dim> lower, upper;

      Sums();
      void
      add(const Sums &other);
    };

    double
    radius_that_reaches(const Probe<dim> &probe) const;

    bool
    selects(const Curve                           &curve,
            const dealii::ArrayView<const double> &properties) const;

    Sums
    sums_of_point(const dealii::Particles::ParticleAccessor<dim> &point) const;

    std::vector<Sums>
    sums_of_curves() const;

    void
    set_node(const Probe<dim>      &probe,
             const NodeMotion<dim> &nodes,
             Statistics            &table) const;

    void
    set_force(const Probe<dim>             &probe,
              const dealii::Tensor<1, dim> &force,
              const dealii::Tensor<1, 3>   &moment_about_origin,
              Statistics                   &table) const;

    void
    set_body_force(const Probe<dim> &probe, Statistics &table) const;

    void
    set_wall_pressure(const Probe<dim>      &probe,
                      const NodeMotion<dim> &nodes,
                      Statistics            &table) const;

    void
    set_height(const Probe<dim> &probe, Statistics &table) const;

    void
    set_error(const Probe<dim> &probe,
              const double      time,
              Statistics       &table) const;

    void
    set_means(const Sums &sums, Statistics &table) const;

    static void
    set_extent(const Sums &sums, Statistics &table);

    const ParticleSet<dim> &particles;
    const double            seconds; ///< between two rows
    std::vector<Curve>      curves;
  };
} // namespace selkie
