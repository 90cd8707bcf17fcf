#include <selkie/solver/displacement_block.h>
#include <selkie/solver/preconditioner.h>

#include <EpetraExt_MatrixMatrix.h>
#include <Epetra_CrsMatrix.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The rows of a rank, restricted to the columns that are displacements (or
    /// pressures) on their owners.
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

    /// Of the nodes of the owned pressures, a list for each direction (m).
    template <int dim>
    std::vector<std::vector<double>>
    pressure_places(const System<dim> &system)
    {
      std::vector<std::vector<double>> places(dim);
      for (const auto &pressure : system.owned_pressures())
        for (unsigned int d = 0; d < dim; ++d)
          places[d].push_back(system.cloud.position(pressure.node)[d]);
      return places;
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
                    std::make_unique<const Multigrid>(*S_hats,
                                                      1,
                                                      pressure_places(system)))
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
  make_block_triangular(const System<dim> &system)
  {
    const auto &hats = system.hats() ? *system.hats() : system.matrix();
    return std::make_unique<BlockTriangular<dim>>(system, hats.epetra());
  }

  template std::unique_ptr<const Preconditioner>
  make_block_triangular(const System<2> &);
  template std::unique_ptr<const Preconditioner>
  make_block_triangular(const System<3> &);
} // namespace selkie
