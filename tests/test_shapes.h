#pragma once

#include <selkie/laws/law.h>
#include <selkie/scene/scene.h>

#include <deal.II/base/numbers.h>

#include <cmath>
#include <memory>

/// Small stand-ins for what a scene file would give.
namespace selkie::test
{
  template <int dim>
  class Box : public Shape<dim>
  {
  public:
    Box(const dealii::Point<dim> &lower, const dealii::Point<dim> &upper)
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

  /// Disc or ball.
  template <int dim>
  class Ball : public Shape<dim>
  {
  public:
    Ball(const dealii::Point<dim> &center, const double radius)
      : center(center)
      , radius(radius)
    {}

    bool
    contains(const dealii::Point<dim> &x) const override
    {
      return x.distance(center) <= radius;
    }

    dealii::BoundingBox<dim>
    bounding_box() const override
    {
      dealii::Point<dim> lower = center, upper = center;
      for (unsigned int d = 0; d < dim; ++d)
        {
          lower[d] -= radius;
          upper[d] += radius;
        }
      return dealii::BoundingBox<dim>({lower, upper});
    }

    double
    volume() const override
    {
      return dealii::numbers::PI * radius * radius *
             (dim == 2 ? 1. : 4. / 3. * radius);
    }

  private:
    const dealii::Point<dim> center;
    const double             radius;
  };

  /// The unit cube, 10 (2D) or 6 (3D) cells a direction, refined twice in a
  /// ball off its centre and once in a corner box.
  template <int dim>
  Domain<dim>
  graded_domain()
  {
    Domain<dim>        domain;
    dealii::Point<dim> center, near_corner;
    for (unsigned int d = 0; d < dim; ++d)
      {
        domain.upper[d] = 1.;
        domain.cells[d] = dim == 2 ? 10 : 6;
        center[d]       = 0.4 + 0.1 * d;
        near_corner[d]  = 0.1;
      }
    domain.refinements = {
      {"ball", std::make_shared<Ball<dim>>(center, dim == 2 ? 0.15 : 0.08), 2},
      {"corner",
       std::make_shared<Box<dim>>(dealii::Point<dim>(), near_corner),
       1}};
    return domain;
  }

  class TestLaw : public Law
  {
  public:
    explicit TestLaw(const Phase kind, const double rho = 1000.)
      : kind(kind)
      , rho(rho)
    {}

    Phase
    phase() const override
    {
      return kind;
    }

    double
    density() const override
    {
      return rho;
    }

    double
    sound_speed() const override
    {
      return 1.;
    }

  private:
    const Phase  kind;
    const double rho;
  };
} // namespace selkie::test
