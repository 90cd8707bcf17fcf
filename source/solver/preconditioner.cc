#include <selkie/base/exceptions.h>
#include <selkie/solver/float_block.h>
#include <selkie/solver/multigrid.h>
#include <selkie/solver/preconditioner.h>
#include <selkie/solver/two_level.h>

#include <EpetraExt_MatrixMatrix.h>
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

    /// The inverses of the diagonal blocks of the nodes' displacements.
    template <int dim, typename Number>
    class NodeDiagonal
    {
    public:
      explicit NodeDiagonal(const unsigned int n_nodes)
        : blocks(n_nodes)
      {}

      /// @param blocks of the diagonal, not yet inverted
      explicit NodeDiagonal(std::vector<Tensor<2, dim, Number>> &&blocks)
        : blocks(std::move(blocks))
      {
        invert();
      }

      void
      add(const unsigned int row, const unsigned int column, const double value)
      {
        if (row / dim == column / dim)
          blocks[row / dim][row % dim][column % dim] = value;
      }

      void
      invert()
      {
        for (auto &block : blocks)
          block = dealii::invert(block);
      }

      template <typename VectorType>
      void
      vmult(VectorType &x, const VectorType &b) const
      {
        for (unsigned int node = 0; node < blocks.size(); ++node)
          for (unsigned int i = 0; i < dim; ++i)
            {
              Number sum = 0.;
              for (unsigned int j = 0; j < dim; ++j)
                sum += blocks[node][i][j] * b.local_element(node * dim + j);
              x.local_element(node * dim + i) = sum;
            }
        for (unsigned int i = dim * blocks.size(); i < x.locally_owned_size();
             ++i)
          x.local_element(i) = 0.;
      }

    private:
      std::vector<Tensor<2, dim, Number>> blocks;
    };

    template <int dim>
    class NodeBlockJacobi : public Preconditioner
    {
    public:
      explicit NodeBlockJacobi(const System<dim> &system)
        : diagonal(blocks_of(system))
      {}

      void
      vmult(Vector &x, const Vector &b) const override
      {
        diagonal.vmult(x, b);
      }

    private:
      static NodeDiagonal<dim, double>
      blocks_of(const System<dim> &system)
      {
        if (system.points())
          return NodeDiagonal<dim, double>(system.points()->node_blocks());
        NodeDiagonal<dim, double> diagonal(system.n_owned_displacements() /
                                           dim);
        int                      *start, *column;
        double                   *values;
        system.matrix().epetra().ExtractCrsDataPointers(start, column, values);
        for (unsigned int i = 0; i < system.n_owned_displacements(); ++i)
          for (int k = start[i]; k < start[i + 1]; ++k)
            diagonal.add(i, column[k], values[k]);
        diagonal.invert();
        return diagonal;
      }

      const NodeDiagonal<dim, double> diagonal;
    };

    /// ML on the matrix itself.
    template <int dim>
    class Ml : public Preconditioner
    {
    public:
      explicit Ml(const System<dim> &system)
        : matrix(system.shared_matrix())
        , ml(matrix->epetra(), dim, rigid_body_modes(system))
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

    template <int dim>
    std::shared_ptr<NodeDiagonal<dim, float>>
    diagonal_of(const FloatBlock &A, const unsigned int n_nodes)
    {
      auto diagonal = std::make_shared<NodeDiagonal<dim, float>>(n_nodes);
      A.for_each([&](const unsigned int row,
                     const unsigned int column,
                     const float value) { diagonal->add(row, column, value); });
      diagonal->invert();
      return diagonal;
    }

    template <int dim>
    std::shared_ptr<NodeDiagonal<dim, float>>
    diagonal_of(const PointTangent<dim, float> &A, const unsigned int)
    {
      return std::make_shared<NodeDiagonal<dim, float>>(A.node_blocks());
    }

    /// A vector to multiply the system's tangent with.
    template <int dim>
    FloatVector
    float_vector(const System<dim> &system)
    {
      if (!system.points())
        return float_vector(system.matrix());
      FloatVector result;
      result.reinit(system.partitioner());
      return result;
    }

    /// The displacement block of the system's tangent, and what is near its
    /// inverse.
    template <int dim, typename Operator>
    class DisplacementBlock
    {
    public:
      /// @param hats the same block of the hat functions' matrix; it has to
      ///   outlive this
      DisplacementBlock(const System<dim>                &system,
                        const Epetra_CrsMatrix           &hats,
                        std::unique_ptr<const Operator> &&block)
        : A(std::move(block))
        , inverse(*A,
                  diagonal_of<dim>(*A, system.n_owned_displacements() / dim),
                  float_vector(system),
                  0,
                  system.n_owned_displacements(),
                  std::make_unique<const Multigrid>(hats,
                                                    dim,
                                                    rigid_body_modes(system)))
      {}

      const std::unique_ptr<const Operator>              A;
      const TwoLevel<Operator, NodeDiagonal<dim, float>> inverse;
    };

    /// A copy of the matrix's block.
    template <int dim>
    std::unique_ptr<const FloatBlock>
    displacements_of(const System<dim> &system)
    {
      return std::make_unique<const FloatBlock>(system,
                                                Part::displacements,
                                                Part::displacements);
    }

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

    /// The rows [row_begin, row_end) of a rank, restricted to the columns that
    /// are displacements (or pressures) on their owners.
    class Blocks
    {
    public:
      template <int dim>
      Blocks(const System<dim> &system, const Epetra_CrsMatrix &K)
        : n_u(system.n_owned_displacements())
        , n(system.n_owned())
        , u_map(-1, n_u, K.RowMap().MyGlobalElements(), 0, K.Comm())
        , p_map(-1, n - n_u, K.RowMap().MyGlobalElements() + n_u, 0, K.Comm())
      {
        // Which columns are pressures: told by their owners.
        Epetra_Vector kind(K.DomainMap()), column_kind(K.ColMap());
        for (int i = n_u; i < n; ++i)
          kind[i] = 1.;
        if (K.Importer() != nullptr)
          column_kind.Import(kind, *K.Importer(), Insert);
        else
          column_kind = kind;

        A  = extract(K, 0, n_u, column_kind, 0., u_map, u_map);
        B  = extract(K, 0, n_u, column_kind, 1., u_map, p_map);
        BT = extract(K, n_u, n, column_kind, 0., p_map, u_map);
        C  = extract(K, n_u, n, column_kind, 1., p_map, p_map);
      }

      const int                         n_u, n;
      Epetra_Map                        u_map, p_map;
      std::unique_ptr<Epetra_CrsMatrix> A, B, BT, C;

    private:
      static std::unique_ptr<Epetra_CrsMatrix>
      extract(const Epetra_CrsMatrix &K,
              const int               begin,
              const int               end,
              const Epetra_Vector    &column_kind,
              const double            kind,
              const Epetra_Map       &row_map,
              const Epetra_Map       &domain_map)
      {
        int    *start, *column;
        double *values;
        K.ExtractCrsDataPointers(start, column, values);
        const Epetra_Map &column_map = K.ColMap();
        auto              block      = std::make_unique<Epetra_CrsMatrix>(
          Copy,
          row_map,
          end > begin ? (start[end] - start[begin]) / (end - begin) : 0);
        std::vector<int>    indices;
        std::vector<double> entries;
        for (int i = begin; i < end; ++i)
          {
            indices.clear();
            entries.clear();
            for (int k = start[i]; k < start[i + 1]; ++k)
              if (column_kind[column[k]] == kind)
                {
                  indices.push_back(column_map.GID(column[k]));
                  entries.push_back(values[k]);
                }
            block->InsertGlobalValues(row_map.GID(i - begin),
                                      indices.size(),
                                      entries.data(),
                                      indices.data());
          }
        block->FillComplete(domain_map, row_map);
        return block;
      }
    };

    /// A vector's values at the pressures.
    class PressureDiagonal
    {
    public:
      PressureDiagonal(const FloatVector &sample, const unsigned int first)
        : first(first)
        , inverse(sample)
      {}

      void
      vmult(FloatVector &x, const FloatVector &b) const
      {
        for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
          x.local_element(i) =
            i < first ? 0.f : inverse.local_element(i) * b.local_element(i);
      }

      const unsigned int first;
      FloatVector        inverse;
    };

    /// S = C + B^T D^{-1} B, D = diag(A), never formed. Pressures are those
    /// from `first` on.
    class Schur : public Subscriptor
    {
    public:
      template <int dim>
      explicit Schur(const System<dim> &system)
        : first(system.n_owned_displacements())
        , B(system, Part::displacements, Part::pressures)
        , BT(system, Part::pressures, Part::displacements)
        , minus_C(system, Part::pressures, Part::pressures)
        , D_inverse(float_vector(system.matrix()))
        , scratch(D_inverse)
      {
        Epetra_Vector diagonal(system.matrix().epetra().RowMap());
        system.matrix().epetra().ExtractDiagonalCopy(diagonal);
        for (unsigned int i = 0; i < first; ++i)
          D_inverse.local_element(i) = 1. / diagonal[i];
        D_inverse.update_ghost_values();
      }

      void
      vmult(FloatVector &y, const FloatVector &x) const
      {
        x.update_ghost_values();
        scratch = 0.f;
        B.vmult_add(scratch, 1.f, x);
        for (unsigned int i = 0; i < first; ++i)
          scratch.local_element(i) *= D_inverse.local_element(i);
        scratch.update_ghost_values();
        y = 0.f;
        BT.vmult_add(y, 1.f, scratch);
        minus_C.vmult_add(y, -1.f, x);
        x.zero_out_ghost_values();
        scratch.zero_out_ghost_values();
      }

      /// B is the transpose of B^T.
      std::shared_ptr<PressureDiagonal>
      diagonal() const
      {
        auto  result = std::make_shared<PressureDiagonal>(scratch, first);
        auto &d      = result->inverse;
        minus_C.for_each([&](const unsigned int row,
                             const unsigned int column,
                             const float        value) {
          if (row == column)
            d.local_element(row) -= value;
        });
        BT.for_each([&](const unsigned int row,
                        const unsigned int column,
                        const float        value) {
          d.local_element(row) +=
            value * value * D_inverse.local_element(column);
        });
        for (unsigned int i = first; i < d.locally_owned_size(); ++i)
          d.local_element(i) = 1.f / d.local_element(i);
        return result;
      }

      const unsigned int first;
      const FloatBlock   B, BT, minus_C;

    private:
      FloatVector         D_inverse;
      mutable FloatVector scratch;
    };

    /// S of the hat functions, formed: they couple with neighbours only.
    std::unique_ptr<Epetra_CrsMatrix>
    form_schur_complement(const Blocks &blocks)
    {
      Epetra_Vector D_inverse(blocks.u_map);
      blocks.A->ExtractDiagonalCopy(D_inverse);
      for (int i = 0; i < D_inverse.MyLength(); ++i)
        D_inverse[i] = 1. / D_inverse[i];
      Epetra_CrsMatrix scaled(*blocks.B);
      scaled.LeftScale(D_inverse);
      Epetra_CrsMatrix product(Copy, blocks.p_map, 0);
      EpetraExt::MatrixMatrix::Multiply(
        *blocks.BT, false, scaled, false, product);
      Epetra_CrsMatrix *sum = nullptr;
      EpetraExt::MatrixMatrix::Add(
        *blocks.C, false, -1., product, false, 1., sum);
      sum->FillComplete(blocks.p_map, blocks.p_map);
      return std::unique_ptr<Epetra_CrsMatrix>(sum);
    }

    /// Whether nodes hardly move each other: at each, what couples it with
    /// others is less than half of the diagonal. Lumped masses of fluids are so
    /// (0.01), consistent ones, stiff solids and viscous fluids are not (1 to
    /// 15). Collective.
    template <int dim>
    bool
    is_nearly_diagonal(const FloatBlock &A, const System<dim> &system)
    {
      std::vector<float> excess(system.n_owned_displacements());
      A.for_each([&](const unsigned int row,
                     const unsigned int column,
                     const float        value) {
        if (row == column)
          excess[row] -= 0.5f * value;
        else if (row / dim != column / dim)
          excess[row] += std::abs(value);
      });
      const bool everywhere =
        std::all_of(excess.begin(), excess.end(), [](const float x) {
          return x <= 0.f;
        });
      return Utilities::MPI::min(
               static_cast<int>(everywhere),
               system.partitioner()->get_mpi_communicator()) == 1;
    }

    /// See make_block_triangular().
    template <int dim>
    class BlockTriangular : public Preconditioner
    {
    public:
      BlockTriangular(const System<dim>      &system,
                      const Epetra_CrsMatrix &hat_matrix)
        : hats(system, hat_matrix)
        , S_hats(form_schur_complement(hats))
        , S(system)
        , S_inverse(S,
                    S.diagonal(),
                    float_vector(system.matrix()),
                    S.first,
                    system.n_owned(),
                    std::make_unique<const Multigrid>(*S_hats, 1))
        , in(float_vector(system.matrix()))
        , u(in)
        , p(in)
      {
        auto block = displacements_of(system);
        if (is_nearly_diagonal(*block, system))
          A_diagonal =
            diagonal_of<dim>(*block, system.n_owned_displacements() / dim);
        else
          A = std::make_unique<DisplacementBlock<dim, FloatBlock>>(
            system, *hats.A, std::move(block));
      }

      void
      vmult(Vector &x, const Vector &b) const override
      {
        const unsigned int n_u = S.first;
        in.copy_locally_owned_data_from(b);
        S_inverse.vmult(p, in);
        p *= -1.f;
        p.update_ghost_values();
        S.B.vmult_add(in, -1.f, p);
        p.zero_out_ghost_values();
        for (unsigned int i = n_u; i < in.locally_owned_size(); ++i)
          in.local_element(i) = 0.f;
        if (A)
          A->inverse.vmult(u, in);
        else
          A_diagonal->vmult(u, in);
        u += p;
        x.copy_locally_owned_data_from(u);
      }

    private:
      const Blocks                                        hats;
      const std::unique_ptr<Epetra_CrsMatrix>             S_hats;
      const Schur                                         S;
      const TwoLevel<Schur, PressureDiagonal>             S_inverse;
      std::unique_ptr<DisplacementBlock<dim, FloatBlock>> A;
      std::shared_ptr<NodeDiagonal<dim, float>>           A_diagonal;
      mutable FloatVector                                 in, u, p;
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

  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_block_triangular(const System<dim> &system)
  {
    const auto &hats = system.hats() ? *system.hats() : system.matrix();
    return std::make_unique<BlockTriangular<dim>>(system, hats.epetra());
  }

#define INSTANTIATE(dim)                                                       \
  template std::unique_ptr<const Preconditioner> make_jacobi(                  \
    const System<dim> &);                                                      \
  template std::unique_ptr<const Preconditioner> make_node_block_jacobi(       \
    const System<dim> &);                                                      \
  template std::unique_ptr<const Preconditioner> make_ml(const System<dim> &); \
  template std::unique_ptr<const Preconditioner> make_hats(                    \
    const System<dim> &);                                                      \
  template std::unique_ptr<const Preconditioner> make_block_triangular(        \
    const System<dim> &)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
