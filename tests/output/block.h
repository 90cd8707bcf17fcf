#pragma once

#include <selkie/laws/neo_hookean.h>
#include <selkie/laws/newtonian_fluid.h>
#include <selkie/mesh/background_mesh.h>
#include <selkie/particles/particle_set.h>

#include <memory>

/// A solid and a fluid block whose state is known, for tests of the output.
namespace selkie::test
{
  template <int dim>
  class Block : public Shape<dim>
  {
  public:
    Block(const dealii::Point<dim> &lower, const dealii::Point<dim> &upper)
      : box({lower, upper})
    {}

    bool
    contains(const dealii::Point<dim> &x) const override
    {
      return box.point_inside(x);
    }

    dealii::BoundingBox<dim>
    bounding_box() const override
    {
      return box;
    }

    double
    volume() const override
    {
      return box.volume();
    }

  private:
    const dealii::BoundingBox<dim> box;
  };

  template <int dim>
  dealii::Point<dim>
  cube_corner(const double x, const double others)
  {
    dealii::Point<dim> corner;
    for (unsigned int i = 0; i < dim; ++i)
      corner[i] = i == 0 ? x : others;
    return corner;
  }

  constexpr double solid_E = 1e4, solid_nu = 0.25, solid_rho = 1200.;
  constexpr double fluid_K = 2e5, fluid_n = 7., fluid_rho = 1000.;
  constexpr double gravity = 9.81;

  /// The unit box with 8 cells a direction, a solid block in 0.25 <= x <= 0.5
  /// and a fluid one in 0.5 <= x <= 0.75; both 0.25 to 0.75 across.
  template <int dim>
  Scene<dim>
  two_blocks()
  {
    Scene<dim> scene;
    scene.file = "two_blocks.prm";
    for (unsigned int i = 0; i < dim; ++i)
      {
        scene.domain.upper[i] = 1.;
        scene.domain.cells[i] = 8;
      }
    scene.bodies.resize(2);
    scene.bodies[0].name = "solid";
    scene.bodies[0].law =
      std::make_shared<NeoHookean>(solid_E, solid_nu, solid_rho);
    scene.bodies[0].shape =
      std::make_shared<Block<dim>>(cube_corner<dim>(0.25, 0.25),
                                   cube_corner<dim>(0.5, 0.75));
    scene.bodies[0].phase = 1;
    scene.bodies[1].name  = "fluid";
    scene.bodies[1].law =
      std::make_shared<NewtonianFluid>(fluid_K, fluid_n, 0., 0., fluid_rho);
    scene.bodies[1].shape =
      std::make_shared<Block<dim>>(cube_corner<dim>(0.5, 0.25),
                                   cube_corner<dim>(0.75, 0.75));
    scene.inertia        = Inertia();
    scene.gravity        = dealii::Tensor<1, dim>();
    (*scene.gravity)[1]  = -gravity;
    scene.fluid_pressure = FluidPressure();
    return scene;
  }

  /// Scene, mesh and seeded points.
  template <int dim>
  struct Matter
  {
    explicit Matter(const Scene<dim> &scene_given,
                    const MPI_Comm    comm = MPI_COMM_WORLD,
                    const bool        seed = true)
      : scene(scene_given)
      , mesh(make_background_mesh<dim>(scene.domain, comm))
      , particles(scene, *mesh)
    {
      if (seed)
        particles.seed();
    }

    /// Gives all points an affine velocity about the middle of the box, the
    /// solid a stretch and the fluid a volume ratio.
    void
    set_state(const dealii::Tensor<1, dim> &velocity,
              const double                  spin,
              const dealii::Tensor<2, dim> &F,
              const double                  J)
    {
      const auto &columns = particles.columns;
      for (auto &point : particles.handler())
        {
          const auto             properties = point.get_properties();
          const auto             x          = point.get_location();
          dealii::Tensor<1, dim> v          = velocity;
          v[0] -= spin * (x[1] - 0.5);
          v[1] += spin * (x[0] - 0.5);
          columns.v.set(properties, v);
          if (columns.body(properties) == 0)
            columns.F.set(properties, F);
          else
            columns.J.set(properties, J);
        }
    }

    const Scene<dim>                                                   scene;
    std::unique_ptr<dealii::parallel::distributed::Triangulation<dim>> mesh;
    ParticleSet<dim> particles;
  };
} // namespace selkie::test
