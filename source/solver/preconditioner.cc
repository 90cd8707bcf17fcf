#include <selkie/base/exceptions.h>
#include <selkie/solver/preconditioner.h>

#include <deal.II/lac/dynamic_sparsity_pattern.h>
#include <deal.II/lac/precondition.h>

#include <EpetraExt_MatrixMatrix.h>
#include <Epetra_CrsMatrix.h>
#include <Epetra_MultiVector.h>
#include <ml_MultiLevelPreconditioner.h>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// Views of the owned values as Epetra vectors; no copies.
    Epetra_Vector
    view(const Epetra_BlockMap &map, const double *values)
    {
      return Epetra_Vector(View, map, const_cast<double *>(values));
    }

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
      NodeBlockJacobi(const System<dim>                    &system,
                      const TrilinosWrappers::SparseMatrix &matrix)
        : blocks(system.n_owned_displacements() / dim)
      {
        int    *start, *column;
        double *values;
        matrix.trilinos_matrix().ExtractCrsDataPointers(start, column, values);
        for (unsigned int node = 0; node < blocks.size(); ++node)
          for (unsigned int i = 0; i < dim; ++i)
            for (int k = start[node * dim + i]; k < start[node * dim + i + 1];
                 ++k)
              {
                const int j = column[k] - static_cast<int>(node * dim);
                if (j >= 0 && j < dim)
                  blocks[node][i][j] = values[k];
              }
        for (auto &block : blocks)
          block = invert(block);
      }

      void
      vmult(Vector &x, const Vector &b) const override
      {
        for (unsigned int node = 0; node < blocks.size(); ++node)
          for (unsigned int i = 0; i < dim; ++i)
            {
              double sum = 0.;
              for (unsigned int j = 0; j < dim; ++j)
                sum += blocks[node][i][j] * b.local_element(node * dim + j);
              x.local_element(node * dim + i) = sum;
            }
      }

    private:
      std::vector<Tensor<2, dim>> blocks;
    };

    /// ML on an Epetra matrix; with modes for displacements, without for
    /// scalars.
    class Multigrid : public Preconditioner
    {
    public:
      Multigrid(const Epetra_CrsMatrix            &matrix,
                const unsigned int                 n_equations,
                std::vector<std::vector<double>> &&modes)
      {
        Teuchos::ParameterList list;
        ML_Epetra::SetDefaults("SA", list);
        list.set("ML output", 0);
        list.set("PDE equations", static_cast<int>(n_equations));
        list.set("aggregation: threshold", 0.02);
        list.set("aggregation: type", "Uncoupled");
        list.set("smoother: type", "Chebyshev");
        list.set("smoother: sweeps", 2);
        list.set("smoother: Chebyshev alpha", 8.);
        list.set("coarse: type", "Amesos-KLU");
        list.set("coarse: max size", 500);
        for (const auto &mode : modes)
          null_space.insert(null_space.end(), mode.begin(), mode.end());
        if (!modes.empty())
          {
            list.set("null space: type", "pre-computed");
            list.set("null space: dimension", static_cast<int>(modes.size()));
            list.set("null space: vectors", null_space.data());
          }
        ml =
          std::make_unique<ML_Epetra::MultiLevelPreconditioner>(matrix, list);
      }

      void
      apply(const double *b, double *x) const
      {
        const auto &map   = ml->OperatorRangeMap();
        auto        b_epe = view(map, b);
        auto        x_epe = view(map, x);
        ml->ApplyInverse(b_epe, x_epe);
      }

      void
      vmult(Vector &x, const Vector &b) const override
      {
        apply(b.begin(), x.begin());
      }

    private:
      std::vector<double>                                  null_space;
      std::unique_ptr<ML_Epetra::MultiLevelPreconditioner> ml;
    };

    /// Translations and rotations at the owned nodes.
    template <int dim>
    std::vector<std::vector<double>>
    rigid_body_modes(const System<dim> &system)
    {
      constexpr unsigned int           n_modes = dim == 2 ? 3 : 6;
      const auto                      &nodes   = system.owned_nodes();
      std::vector<std::vector<double>> modes(
        n_modes, std::vector<double>(dim * nodes.size(), 0.));
      for (unsigned int k = 0; k < nodes.size(); ++k)
        {
          const Point<dim> &x = system.cloud.position(nodes[k]);
          for (unsigned int d = 0; d < dim; ++d)
            modes[d][dim * k + d] = 1.;
          unsigned int mode = dim;
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = i + 1; j < dim; ++j, ++mode)
              {
                modes[mode][dim * k + i] = -x[j];
                modes[mode][dim * k + j] = x[i];
              }
          for (unsigned int d = 0; d < dim; ++d)
            if (system.held(dim * k + d))
              for (auto &m : modes)
                m[dim * k + d] = 0.;
        }
      return modes;
    }

    /// See make_hats().
    template <int dim>
    class Hats : public Preconditioner
    {
    public:
      explicit Hats(const System<dim> &system)
        : A(system.matrix())
        , hats(system.hats())
        , ml(hats->trilinos_matrix(), dim, rigid_body_modes(system))
      {
        typename Smoother::AdditionalData data;
        data.degree              = 2;
        data.smoothing_range     = 8.;
        data.eig_cg_n_iterations = 8; // its safety factor is 1.2
        data.preconditioner =
          std::make_shared<NodeBlockJacobi<dim>>(system, A);
        smoother.initialize(A, data);
      }

      void
      vmult(Vector &x, const Vector &b) const override
      {
        if (residual.get_partitioner() != b.get_partitioner())
          {
            residual.reinit(b);
            correction.reinit(b);
          }
        smoother.vmult(x, b);
        add_residual(ml, x, b);
        add_residual(smoother, x, b);
      }

    private:
      using Smoother = PreconditionChebyshev<TrilinosWrappers::SparseMatrix,
                                             Vector,
                                             NodeBlockJacobi<dim>>;

      /// x += P (b - A x)
      template <typename Inverse>
      void
      add_residual(const Inverse &P, Vector &x, const Vector &b) const
      {
        A.vmult(residual, x);
        residual.sadd(-1., 1., b);
        P.vmult(correction, residual);
        x += correction;
      }

      const TrilinosWrappers::SparseMatrix                         &A;
      const std::shared_ptr<const TrilinosWrappers::SparseMatrix>   hats;
      const Multigrid                                               ml;
      Smoother                                                      smoother;
      mutable Vector residual, correction;
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

    template <int dim>
    class BlockLDLT : public Preconditioner
    {
    public:
      BlockLDLT(const System<dim>      &system,
                const Epetra_CrsMatrix &K,
                const bool              multigrid_for_displacements)
        : blocks(system, K)
        , D_inverse(blocks.u_map)
      {
        blocks.A->ExtractDiagonalCopy(D_inverse);
        for (int i = 0; i < D_inverse.MyLength(); ++i)
          D_inverse[i] = 1. / D_inverse[i];
        if (multigrid_for_displacements)
          A_multigrid = std::make_unique<Multigrid>(*blocks.A,
                                                    dim,
                                                    rigid_body_modes(system));
        form_schur_complement();
        S_multigrid =
          std::make_unique<Multigrid>(*S,
                                      1,
                                      std::vector<std::vector<double>>());
      }

      void
      vmult(Vector &x, const Vector &b) const override
      {
        const int     n_u = blocks.n_u;
        Epetra_Vector z(blocks.u_map), t(blocks.u_map), r(blocks.p_map);
        solve_A(b.begin(), z.Values());
        blocks.BT->Multiply(false, z, r);
        for (int i = 0; i < r.MyLength(); ++i)
          r[i] -= b.local_element(n_u + i);
        S_multigrid->apply(r.Values(), x.begin() + n_u);
        const auto p = view(blocks.p_map, x.begin() + n_u);
        blocks.B->Multiply(false, p, t);
        Epetra_Vector correction(blocks.u_map);
        solve_A(t.Values(), correction.Values());
        for (int i = 0; i < n_u; ++i)
          x.local_element(i) = z[i] - correction[i];
      }

    private:
      void
      solve_A(const double *b, double *x) const
      {
        if (A_multigrid)
          A_multigrid->apply(b, x);
        else
          for (int i = 0; i < D_inverse.MyLength(); ++i)
            x[i] = D_inverse[i] * b[i];
      }

      void
      form_schur_complement()
      {
        Epetra_CrsMatrix scaled(*blocks.B);
        scaled.LeftScale(D_inverse);
        Epetra_CrsMatrix product(Copy, blocks.p_map, 0);
        EpetraExt::MatrixMatrix::Multiply(
          *blocks.BT, false, scaled, false, product);
        Epetra_CrsMatrix *sum = nullptr;
        EpetraExt::MatrixMatrix::Add(
          *blocks.C, false, -1., product, false, 1., sum);
        S.reset(sum);
        S->FillComplete(blocks.p_map, blocks.p_map);
      }

      const Blocks                      blocks;
      Epetra_Vector                     D_inverse;
      std::unique_ptr<Epetra_CrsMatrix> S;
      std::unique_ptr<Multigrid>        A_multigrid, S_multigrid;
    };
  } // namespace

  std::unique_ptr<const Preconditioner>
  make_jacobi(const TrilinosWrappers::SparseMatrix &matrix)
  {
    return std::make_unique<Jacobi>(matrix.trilinos_matrix());
  }

  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_node_block_jacobi(const System<dim>                    &system,
                         const TrilinosWrappers::SparseMatrix &matrix)
  {
    return std::make_unique<NodeBlockJacobi<dim>>(system, matrix);
  }

  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_ml(const System<dim>                    &system,
          const TrilinosWrappers::SparseMatrix &matrix)
  {
    return std::make_unique<Multigrid>(matrix.trilinos_matrix(),
                                       dim,
                                       rigid_body_modes(system));
  }

  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_hats(const System<dim> &system)
  {
    return std::make_unique<Hats<dim>>(system);
  }

  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_block_ldlt(const System<dim>                    &system,
                  const TrilinosWrappers::SparseMatrix &matrix,
                  const bool multigrid_for_displacements)
  {
    return std::make_unique<BlockLDLT<dim>>(system,
                                            matrix.trilinos_matrix(),
                                            multigrid_for_displacements);
  }

#define INSTANTIATE(dim)                                                 \
  template std::unique_ptr<const Preconditioner> make_node_block_jacobi( \
    const System<dim> &, const TrilinosWrappers::SparseMatrix &);        \
  template std::unique_ptr<const Preconditioner> make_ml(                \
    const System<dim> &, const TrilinosWrappers::SparseMatrix &);        \
  template std::unique_ptr<const Preconditioner> make_hats(              \
    const System<dim> &);                                                \
  template std::unique_ptr<const Preconditioner> make_block_ldlt(        \
    const System<dim> &, const TrilinosWrappers::SparseMatrix &, const bool)
  INSTANTIATE(2);
  INSTANTIATE(3);
#undef INSTANTIATE
} // namespace selkie
