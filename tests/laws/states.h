#pragma once

#include <selkie/laws/kinematics.h>

#include <random>
#include <vector>

/**
 * @file
 * Random but repeatable states for the tests of the laws.
 */
namespace selkie_test
{
  using dealii::Tensor;

  /// One point in the middle of a step.
  struct State
  {
    Tensor<2, 3> F_n;      ///< deformation gradient at the start of the step
    Tensor<2, 3> f;        ///< incremental gradient
    Tensor<2, 3> grad_n_v; ///< sum_a v_a (x) G_a at du_b = 0, 1/s
    Tensor<1, 3> G_a, G_b; ///< grad_n N_a, grad_n N_b, 1/m

    Tensor<2, 3>
    F() const
    {
      return f * F_n;
    }

    /// The state after node b moves by @p du; its velocity follows with slope
    /// @p alpha4.
    State
    moved(const Tensor<1, 3> &du, const double alpha4) const
    {
      State result = *this;
      result.f += outer_product(du, G_b);
      result.grad_n_v += outer_product(alpha4 * du, G_b);
      return result;
    }

    /// A gradient on the current configuration.
    Tensor<1, 3>
    push_forward(const Tensor<1, 3> &G) const
    {
      return dealii::transpose(dealii::invert(f)) * G;
    }

    /// Velocity gradient l.
    Tensor<2, 3>
    l() const
    {
      return grad_n_v * dealii::invert(f);
    }
  };

  /// A vector with @p dim entries in (-size, size).
  template <int dim>
  Tensor<1, dim>
  random_vector(std::mt19937 &generator, const double size)
  {
    std::uniform_real_distribution<double> entry(-size, size);
    Tensor<1, dim>                         result;
    for (unsigned int i = 0; i < dim; ++i)
      result[i] = entry(generator);
    return result;
  }

  /// A tensor with entries in (-size, size).
  template <int dim>
  Tensor<2, dim>
  random_tensor(std::mt19937 &generator, const double size)
  {
    Tensor<2, dim> result;
    for (unsigned int i = 0; i < dim; ++i)
      result[i] = random_vector<dim>(generator, size);
    return result;
  }

  /// A state in dimension @p dim (2: plane strain) with F, F_n and f away from
  /// the identity and from each other.
  template <int dim>
  State
  random_state(std::mt19937 &generator)
  {
    using selkie::extend;
    State state;
    state.F_n = selkie::identity() +
                extend(random_tensor<dim>(generator, 0.25), /*zz=*/0.);
    state.f = selkie::identity() +
              extend(random_tensor<dim>(generator, 0.15), /*zz=*/0.);
    state.grad_n_v = extend(random_tensor<dim>(generator, 3.), /*zz=*/0.);
    state.G_a      = extend(random_vector<dim>(generator, 2.));
    state.G_b      = extend(random_vector<dim>(generator, 2.));
    return state;
  }

  /// Twelve states, half of them plane strain.
  inline std::vector<State>
  random_states()
  {
    std::mt19937       generator(20230704);
    std::vector<State> states;
    for (unsigned int i = 0; i < 6; ++i)
      {
        states.push_back(random_state<2>(generator));
        states.push_back(random_state<3>(generator));
      }
    return states;
  }

  /// A rotation: the exponential of a skew tensor, by Rodrigues' formula.
  inline Tensor<2, 3>
  random_rotation(std::mt19937 &generator)
  {
    Tensor<1, 3> axis  = random_vector<3>(generator, 2.);
    const double angle = axis.norm();
    axis /= angle;
    Tensor<2, 3> skew;
    skew[0][1] = -(skew[1][0] = axis[2]);
    skew[2][0] = -(skew[0][2] = axis[1]);
    skew[1][2] = -(skew[2][1] = axis[0]);
    return selkie::identity() + std::sin(angle) * skew +
           (1. - std::cos(angle)) * (skew * skew);
  }

  /// Central difference of the vector function @p residual(du) at du = 0:
  /// entry [i][k] is d residual_i / d du_k.
  template <typename Function>
  Tensor<2, 3>
  difference_quotient(const Function &residual)
  {
    const double h = 1e-5;
    Tensor<2, 3> result;
    for (unsigned int k = 0; k < 3; ++k)
      {
        Tensor<1, 3> du;
        du[k]                    = h;
        const Tensor<1, 3> slope = (residual(du) - residual(-du)) / (2. * h);
        for (unsigned int i = 0; i < 3; ++i)
          result[i][k] = slope[i];
      }
    return result;
  }

  /// |a - b| / |b|.
  inline double
  relative_difference(const Tensor<2, 3> &a, const Tensor<2, 3> &b)
  {
    return (a - b).norm() / b.norm();
  }
} // namespace selkie_test
