#pragma once

#include <selkie/base/exceptions.h>
#include <selkie/solver/float_block.h>
#include <selkie/solver/multigrid.h>

#include <deal.II/lac/precondition.h>
#include <deal.II/lac/solver_control.h>

#include <memory>
#include <utility>
#include <vector>

namespace selkie
{
  /**
   * An approximate inverse of an operator on LME functions (solver.md, section
   * 2): Chebyshev sweeps of degree 2 on the operator itself, one V-cycle of ML
   * on a matrix of hat functions on the same nodes, and the sweeps again. ML
   * sees 9 points (27 in 3D) where LME couples 50 to 200, and the sweeps see
   * the short waves, which LME makes softer. Symmetric, in single precision.
   *
   * @tparam Operator y.vmult(x) on FloatVector
   * @tparam Diagonal the inverse of its (block) diagonal
   */
  template <typename Operator, typename Diagonal>
  class TwoLevel
  {
  public:
    /// @param begin,end the owned unknowns that it is about: ML's rows
    /// @throw LinearSolverFailure, on all ranks, for an operator that is not
    /// finite
    TwoLevel(const Operator                    &A,
             const std::shared_ptr<Diagonal>   &diagonal,
             const FloatVector                 &sample,
             const unsigned int                 begin,
             const unsigned int                 end,
             std::unique_ptr<const Multigrid> &&ml)
      : A(A)
      , begin(begin)
      , end(end)
      , ml(std::move(ml))
      , in(end - begin)
      , out(end - begin)
    {
      residual.reinit(sample);
      correction.reinit(sample);
      typename Smoother::AdditionalData data;
      data.degree              = 2;
      data.smoothing_range     = 8.;
      data.eig_cg_n_iterations = 8; // its safety factor is 1.2
      data.preconditioner      = diagonal;
      smoother.initialize(A, data);
      try
        {
          smoother.estimate_eigenvalues(sample);
        }
      catch (const dealii::SolverControl::NoConvergence &)
        {
          throw LinearSolverFailure("Chebyshev smoother: the operator's "
                                    "eigenvalues are not finite");
        }
    }

    /// Other entries of x than those that it is about become zero.
    void
    vmult(FloatVector &x, const FloatVector &b) const
    {
      smoother.vmult(x, b);
      A.vmult(residual, x);
      residual.sadd(-1.f, 1.f, b);
      for (unsigned int i = begin; i < end; ++i)
        in[i - begin] = residual.local_element(i);
      ml->apply(in.data(), out.data());
      for (unsigned int i = begin; i < end; ++i)
        x.local_element(i) += out[i - begin];
      A.vmult(residual, x);
      residual.sadd(-1.f, 1.f, b);
      smoother.vmult(correction, residual);
      x += correction;
    }

  private:
    using Smoother =
      dealii::PreconditionChebyshev<Operator, FloatVector, Diagonal>;

    const Operator                        &A;
    const unsigned int                     begin, end;
    const std::unique_ptr<const Multigrid> ml;
    Smoother                               smoother;
    mutable FloatVector                    residual, correction;
    mutable std::vector<double>            in, out;
  };
} // namespace selkie
