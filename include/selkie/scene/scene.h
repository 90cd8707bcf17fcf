#pragma once

#include <selkie/base/expression.h>
#include <selkie/laws/law.h>
#include <selkie/scene/effect.h>
#include <selkie/scene/shapes.h>

#include <deal.II/base/point.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/**
 * @file
 * The scene: plain data, complete and checked. After reading nothing sees
 * ParameterHandler, and nothing changes a scene: the program passes it on as
 * `const Scene<dim> &`. All quantities are in SI units. An effect that the
 * scene does not list is an empty std::optional or an empty list.
 */
namespace selkie
{
  enum class Approximation
  {
    lme_mpm, ///< LME functions on the nodes of the background mesh
    q4_mpm,  ///< hat functions on the background mesh: the classical MPM
    q4_fem   ///< Lagrangian finite elements: the mesh moves with the matter
  };

  /// What the nodes of a wall, a node set or an obstacle do.
  enum class NodeCondition
  {
    free,       ///< nothing prescribed
    fixed,      ///< all displacement components are zero
    slip,       ///< walls only: the normal component is zero
    prescribed, ///< the components of a given velocity that are not `free`
    moving      ///< node sets only: inside a shape that moves along a path
  };

  /// One wall of the domain box, in deal.II's boundary order (x-, x+, y-, …).
  template <int dim>
  struct Wall
  {
    NodeCondition                          condition = NodeCondition::slip;
    std::array<bool, dim>                  components{}; ///< which are held
    std::shared_ptr<VectorExpression<dim>> velocity;     ///< m/s, if prescribed
  };

  /// A mesh that is not the lattice of the domain's box.
  struct ImportedMesh
  {
    std::string  file;                 ///< for dealii::GridIn, e.g. gmsh's .msh
    std::string  generator, arguments; ///< of dealii::GridGenerator
    unsigned int global_refinements = 0; ///< of all its cells
  };

  /// The box in which everything happens, and its background mesh.
  template <int dim>
  struct Domain
  {
    dealii::Point<dim>             lower, upper; ///< m
    std::array<unsigned int, dim>  cells;        ///< coarsest active cells
    std::array<Wall<dim>, 2 * dim> walls;
    std::optional<ImportedMesh>    mesh; ///< instead of the box's lattice
    /// Cells that touch the shape are refined this many times more.
    struct Refinement
    {
      std::string                       name;
      std::shared_ptr<const Shape<dim>> shape;
      unsigned int                      levels = 1;
    };
    std::vector<Refinement> refinements;
    /// Between two looks at how evenly the ranks share the points; 0: none.
    unsigned int balance_steps = 10;
  };

  /// Nodes of the background mesh inside a shape: a clamp, a rigid obstacle.
  /// The nodes do not move; the shape does if it is `moving`: a piston, a
  /// stirrer.
  template <int dim>
  struct NodeSet
  {
    std::string                            name;
    std::shared_ptr<const Shape<dim>>      shape;
    NodeCondition                          condition = NodeCondition::fixed;
    std::array<bool, dim>                  components{}; ///< which are held
    std::shared_ptr<VectorExpression<dim>> velocity;     ///< m/s, if prescribed
    std::shared_ptr<VectorExpression<dim>> path;         ///< m, of t, if moving
  };

  /// A named region of one material.
  template <int dim>
  struct Body
  {
    std::string                       name;
    std::shared_ptr<const Law>        law;
    std::shared_ptr<const Shape<dim>> shape;
    unsigned int                      points_per_direction = 2; ///< per cell
    double                            jitter = 0; ///< of the point spacing
    std::shared_ptr<VectorExpression<dim>> initial_velocity; ///< may be null
    /// From where the lattice has a point to where it starts (m); may be null.
    std::shared_ptr<VectorExpression<dim>> initial_displacement;
    std::shared_ptr<Expression> initial_pressure; ///< of fluids; may be null
    /// Which points share nodes: all fluids are phase 0, each solid body is a
    /// phase of its own (1, 2, …).
    unsigned int phase = 0;
    /// Which of the nodes at a vertex are the body's: NodeCloud::layer().
    unsigned int layer = 0;
    /// Whether its pressure is an unknown of its own: fluids, and with `mixed
    /// pressure` the solids whose law decouples shape and volume.
    bool has_pressure = false;
  };

  struct LmeParameters
  {
    double gamma             = 3.;    ///< locality, beta_a = gamma / h_a^2
    double support_tolerance = 1e-6;  ///< weights below it are cut
    double newton_tolerance  = 1e-12; ///< |r| / h
  };

  enum class MassKind
  {
    automatic, ///< until the scene is complete: lumped for MPM
    lumped,
    consistent
  };

  /// The effect `inertia`: mass matrix, velocity, acceleration, Newmark.
  struct Inertia
  {
    MassKind mass          = MassKind::automatic;
    double   newmark_beta  = 0.25;
    double   newmark_gamma = 0.5;
  };

  /// How velocities travel between points and nodes.
  enum class TransferScheme
  {
    flip, ///< points add the nodes' increments
    tpic  ///< Taylor PIC: points carry their velocity gradient
  };

  struct Transfer
  {
    TransferScheme scheme        = TransferScheme::flip;
    double         flip_fraction = 1.; ///< rest is PIC
    double         flip_interval = 0.; ///< in which it is mixed (s); 0: a step
    unsigned int   order         = 1;  ///< of the projection to the nodes

    /// Share of FLIP in a step of @p dt.
    double
    flip_share(const double dt) const
    {
      return flip_interval > 0. ? std::pow(flip_fraction, dt / flip_interval)
                                : flip_fraction;
    }
  };

  /// The fluid's volume rules; present exactly when the scene has a fluid
  /// (formulation.md 4, quadrature.md).
  struct FluidPressure
  {
    double volume_rate      = 20.; ///< of the volume drift's correction (1/s)
    double volume_deadband  = 0.1;
    bool   gauss_full_cells = true; ///< integrate full cells at Gauss points
  };

  /// The effect `wall release`: walls that push the bodies but do not hold
  /// them.
  template <int dim>
  struct WallRelease
  {
    std::array<bool, 2 * dim> walls{};
    std::vector<unsigned int> bodies; ///< empty: all solids
  };

  /// What is done with points that do not fit their cells any more.
  enum class PointAdaptation
  {
    keep,
    split,
    split_and_merge
  };

  /// The effect `adaptivity`: a background mesh that follows the matter. A
  /// limit of 0 is no criterion.
  struct Adaptivity
  {
    unsigned int steps      = 10; ///< between two adaptations, at most
    unsigned int finer      = 1;  ///< levels, where a criterion holds
    unsigned int coarser    = 0;  ///< levels, where none does
    unsigned int buffer     = 2;  ///< around these cells, in the finest ones
    unsigned int most_cells = 100000000;

    bool                      surface   = false;
    bool                      interface = false;
    std::vector<unsigned int> bodies;
    double                    strain           = 0;
    double                    strain_variation = 0; ///< in a cell
    double                    strain_error     = 0; ///< to the recovered one
    double          velocity = 0; ///< difference in a cell, of the largest
    double          pressure = 0; ///< difference in a cell, of the largest
    double          error    = 0; ///< of a coarser velocity, of the largest
    PointAdaptation points   = PointAdaptation::split_and_merge;
  };

  /// The effect `traction`: dead load on one face of a box-shaped body.
  template <int dim>
  struct Traction
  {
    std::string                            name;
    unsigned int                           body = 0;
    unsigned int                           face = 0; ///< x-, x+, y-, …
    std::shared_ptr<VectorExpression<dim>> value;    ///< Pa, of X, x, t
  };

  struct TimeParameters
  {
    bool         estimate_error = false; ///< of time steps and mesh
    double       end_time       = 1.;    ///< s
    double       step           = 1e-3;  ///< s; the largest
    double       acoustic_cfl   = 0.;    ///< largest c dt / h; 0: any
    double       largest_error  = 0.;    ///< of a step, in cells; 0: any
    double       smallest_step  = 0.;    ///< s; 0: step / 1024
    unsigned int easy_steps     = 5;     ///< good steps before a cut step grows
    double       max_move       = 0.5;   ///< cells a point may move in a step
    double       largest_energy_jump = 0.; ///< of the energy in play; 0: any
  };

  struct NewtonParameters
  {
    double       tolerance      = 1e-9;
    unsigned int max_iterations = 25;
    bool         line_search    = true;
  };

  enum class SolverKind
  {
    automatic,
    cg_jacobi,
    cg_ml,
    cg_hats,
    gmres_block,
    minres_jacobi,
    direct
  };

  struct LinearSolverParameters
  {
    SolverKind   kind           = SolverKind::automatic;
    double       tolerance      = 1e-8; ///< relative, true residual
    double       loosest        = 1e-4; ///< where Newton needs no more
    unsigned int max_iterations = 2000;
    unsigned int direct_below   = 200; ///< unknowns
  };

  /// What is done with a point that leaves the domain.
  enum class LeavingPolicy
  {
    stop,
    keep,
    remove
  };

  /// One curve in probes/NAME.csv.
  template <int dim>
  struct Probe
  {
    enum class Kind
    {
      point,  ///< mean of the points that were within `radius` of `position`
      node,   ///< the node nearest to `position`; Lagrangian meshes
      region, ///< mean of the points that were inside `shape` at the start
      wall_force,    ///< reaction on wall `wall` and moment about `position`
      wall_pressure, ///< mean of the fluid's pressure on `shape` on `wall`
      height,        ///< surface of body `body` along `axis` above `position`
      body_force,    ///< what all around does to body `body`, and the moment
      front,         ///< largest coordinate `axis` reached by body `body`, m
      extent, ///< min, max of body's coordinates and its volume, centroid
      error   ///< of body's `quantity` against `function`
    };
    enum class Quantity
    {
      displacement, ///< m
      velocity      ///< m/s
    };
    std::string                       name;
    Kind                              kind = Kind::point;
    dealii::Point<dim>                position;
    double                            radius = 0;
    std::shared_ptr<const Shape<dim>> shape;
    unsigned int                      wall = 0;
    unsigned int                      body = 0;
    unsigned int                      axis = 0;

    Quantity                               quantity = Quantity::displacement;
    std::shared_ptr<VectorExpression<dim>> function; ///< exact, of X, t
  };

  /// Beyond which a figure of the audit is warned of, and fails; 0: never.
  using AuditLimit = std::array<double, 2>;

  /// The effect `audit`: what is summed after every step, and its limits.
  struct AuditLimits
  {
    AuditLimit energy_gain{{0.05, 0.5}};  ///< of the energy in play
    AuditLimit mass{{1e-10, 1e-8}};       ///< relative change
    AuditLimit volume{{0.05, 0.2}};       ///< fluids: relative change
    AuditLimit smallest_J{{0.2, 0.05}};   ///< below which
    AuditLimit unseen_energy{{0.2, 0.6}}; ///< of the energy in play
    AuditLimit checkerboard{{0.2, 0.6}};  ///< of the pressure
  };

  struct OutputParameters
  {
    std::string  directory;                 ///< set by --output or the scene
    double       interval           = 0.02; ///< s between VTU files; 0: none
    bool         mesh               = true; ///< mesh.pvd with nodal fields
    unsigned int checkpoint_steps   = 0;    ///< between checkpoints; 0: none
    double       checkpoint_minutes = 10.;  ///< of wall time; 0: none
  };

  /// The value that a parameter has in the end, and who gave it.
  struct ParameterValue
  {
    std::string value;
    std::string origin; ///< "file.prm:12", "--set" or, for a default, ""
  };

  template <int dim>
  struct Scene
  {
    std::string   file; ///< the .prm that it was read from
    std::string   title;
    Approximation approximation = Approximation::lme_mpm;
    Domain<dim>   domain;

    std::vector<Body<dim>>    bodies;
    std::vector<NodeSet<dim>> node_sets;

    LmeParameters          lme;
    Transfer               transfer;
    TimeParameters         time;
    NewtonParameters       newton;
    LinearSolverParameters linear_solver;
    OutputParameters       output;
    LeavingPolicy          leaving = LeavingPolicy::stop;

    /// What the scene calls for, in the order of effect_table().
    std::vector<ActiveEffect<dim>> effects;

    // The parameters of effects that others read as well: absent unless the
    // scene calls for the effect.
    std::optional<Inertia>                inertia;
    std::optional<dealii::Tensor<1, dim>> gravity; ///< m/s^2
    std::optional<FluidPressure>          fluid_pressure;
    std::vector<Traction<dim>>            tractions;
    std::optional<WallRelease<dim>>       release; ///< wall release
    std::optional<Adaptivity>             adaptivity;
    bool mixed_solids = false; ///< mixed pressure
    /// The bodies that have nodes of their own: contact.
    std::optional<std::vector<unsigned int>> contact;
    /// Walls of which a term wants the wetted faces' Gauss points; those that
    /// are not `slip` have none.
    std::optional<std::array<bool, 2 * dim>> wall_points;
    std::vector<Probe<dim>>                  probes;
    std::optional<AuditLimits>               audit;

    /// Every parameter by its path, as in "Bodies/water/Density": for messages
    /// and for reports.
    std::map<std::string, ParameterValue> parameters;

    /// The same as a .prm, which reads back as this scene: parameters.prm.
    std::string resolved;

    /// Of nodes at each vertex.
    unsigned int
    n_layers() const
    {
      unsigned int n = 1;
      for (const auto &body : bodies)
        n = std::max(n, body.layer + 1);
      return n;
    }

    /// Whether the mesh moves with the matter: points stay in their cells and
    /// nodes keep displacement, velocity and acceleration of their own.
    bool
    lagrangian_mesh() const
    {
      return approximation == Approximation::q4_fem;
    }

    bool
    has_fluid() const
    {
      return fluid_pressure.has_value();
    }

    /// Whether nodes have a pressure: those of fluids or those of solids.
    bool
    has_pressure() const
    {
      return has_fluid() || mixed_solids;
    }

    /// Whether the drift of the fluids' volume is corrected.
    bool
    corrects_volume() const
    {
      return has_fluid() && !lagrangian_mesh() &&
             fluid_pressure->volume_rate > 0.;
    }

    /// The phases whose nodes have a pressure, as bits.
    unsigned int
    pressure_phases() const
    {
      unsigned int phases = 0;
      for (const auto &body : bodies)
        if (body.has_pressure)
          phases |= 1u << body.phase;
      return phases;
    }

    /// What the nodes' pressure of a phase is called: that of fluids
    /// "pressure", that of a solid "pressure of NAME".
    std::string
    pressure_name(const unsigned int phase) const
    {
      for (const auto &body : bodies)
        if (body.phase == phase && phase != 0)
          return "pressure of " + body.name;
      return "pressure";
    }

    bool
    has_effect(const std::string &name) const
    {
      return std::any_of(effects.begin(),
                         effects.end(),
                         [&name](const ActiveEffect<dim> &active) {
                           return active.name == name;
                         });
    }

    bool
    has_solid() const
    {
      return std::any_of(bodies.begin(), bodies.end(), [](const auto &body) {
        return body.law->phase() == Phase::solid;
      });
    }

    std::vector<std::string>
    effect_names() const
    {
      std::vector<std::string> names;
      for (const auto &active : effects)
        names.push_back(active.name);
      return names;
    }
  };
} // namespace selkie
