#include <selkie/solver/displacement_block.h>
#include <selkie/solver/preconditioner.h>

#include <Epetra_CrsMatrix.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    class Jacobi : public Preconditioner
    {
    public:
      explicit Jacobi(const Epetra_CrsMatrix &matrix)
      {
        Epetra_Vector diagonal(matrix.RowMap());
        matrix.ExtractDiagonalCopy(diagonal);
        inverse.resize(diagonal.MyLength());
        for (int i = 0; i < diagonal.MyLength(); ++i)
          inverse[i] = diagonal[i] != 0. ? 1. / std::abs(diagonal[i]) : 1.;
      }

      void
      vmult(Vector &x, const Vector &b) const override
      {
        for (unsigned int i = 0; i < inverse.size(); ++i)
          x.local_element(i) = inverse[i] * b.local_element(i);
      }

    private:
      std::vector<double> inverse;
    };

    template <int dim>
    class NodeBlockJacobi : public Preconditioner
    {
    public:
      explicit NodeBlockJacobi(const System<dim> &system)
        : diagonal(system.points()
                     ? std::make_shared<NodeDiagonal<dim, double>>(
                         system.points()->node_blocks())
                     : diagonal_of_matrix<dim, double>(system))
      {}

      void
      vmult(Vector &x, const Vector &b) const override
      {
        diagonal->vmult(x, b);
      }

    private:
      const std::shared_ptr<NodeDiagonal<dim, double>> diagonal;
    };

    /// ML on the matrix itself.
    template <int dim>
    class Ml : public Preconditioner
    {
    public:
      explicit Ml(const System<dim> &system)
        : matrix(system.shared_matrix())
        , ml(matrix->epetra(),
             dim,
             node_places(system),
             rigid_body_modes(system))
      {}

      void
      vmult(Vector &x, const Vector &b) const override
      {
        ml.apply(b.begin(), x.begin());
      }

    private:
      const std::shared_ptr<const SystemMatrix> matrix;
      const Multigrid                           ml;
    };

    /// See make_hats().
    template <int dim, typename Operator>
    class Hats : public Preconditioner
    {
    public:
      Hats(const System<dim> &system, std::unique_ptr<const Operator> &&A)
        : hats(system.hats())
        , block(system, hats->epetra(), std::move(A))
        , in(float_vector(system))
        , out(in)
      {}

      void
      vmult(Vector &x, const Vector &b) const override
      {
        in.copy_locally_owned_data_from(b);
        block.inverse.vmult(out, in);
        x.copy_locally_owned_data_from(out);
      }

    private:
      const std::shared_ptr<const SystemMatrix> hats;
      const DisplacementBlock<dim, Operator>    block;
      mutable FloatVector                       in, out;
    };

  } // namespace

  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_jacobi(const System<dim> &system)
  {
    return std::make_unique<Jacobi>(system.matrix().epetra());
  }

  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_node_block_jacobi(const System<dim> &system)
  {
    return std::make_unique<NodeBlockJacobi<dim>>(system);
  }

  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_ml(const System<dim> &system)
  {
    return std::make_unique<Ml<dim>>(system);
  }

  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_hats(const System<dim> &system)
  {
    if (!system.points())
      return std::make_unique<Hats<dim, FloatBlock>>(system,
                                                     displacements_of(system));
    using Points = PointTangent<dim, float>;
    return std::make_unique<Hats<dim, Points>>(
      system, std::make_unique<const Points>(*system.points()));
  }

#define INSTANTIATE(dim)                                                       \
  template std::unique_ptr<const Preconditioner> make_jacobi(                  \
    const System<dim> &);                                                      \
  template std::unique_ptr<const Preconditioner> make_node_block_jacobi(       \
    const System<dim> &);                                                      \
  template std::unique_ptr<const Preconditioner> make_ml(const System<dim> &); \
  template std::unique_ptr<const Preconditioner> make_hats(const System<dim> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
