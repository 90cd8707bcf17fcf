#include <selkie/solver/displacement_block.h>
#include <selkie/solver/preconditioner.h>
#include <selkie/solver/tangent_blocks.h>

#include <EpetraExt_MatrixMatrix.h>
#include <Epetra_Comm.h>
#include <Epetra_CrsMatrix.h>

#include <algorithm>
#include <cmath>

namespace selkie
{
  using namespace dealii;

  namespace
  {
    /// The hat functions' tangent: a rank's rows, restricted to the columns
    /// that are displacements (or pressures) on their owners.
    class HatBlocks
    {
    public:
      template <int dim>
      HatBlocks(const System<dim> &system, const Epetra_CrsMatrix &K)
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

    /// Products with a vector's values at the pressures, from `first` on.
    struct PressureDiagonal
    {
      void
      vmult(FloatVector &x, const FloatVector &b) const
      {
        for (unsigned int i = 0; i < x.locally_owned_size(); ++i)
          x.local_element(i) =
            i < first ? 0.f : inverse.local_element(i) * b.local_element(i);
      }

      unsigned int first;
      FloatVector  inverse;
    };

    /// S = B^T D^{-1} B - C, D = diag(A), never formed.
    template <typename Blocks>
    class Schur : public Subscriptor
    {
    public:
      Schur(const Blocks &blocks, const unsigned int first_pressure)
        : blocks(blocks)
        , first(first_pressure)
        , D_inverse(blocks.D_inverse())
      {
        scratch.reinit(D_inverse);
      }

      void
      vmult(FloatVector &y, const FloatVector &x) const
      {
        blocks.vmult_B(scratch, x);
        for (unsigned int i = 0; i < first; ++i)
          scratch.local_element(i) *= D_inverse.local_element(i);
        for (unsigned int i = first; i < x.locally_owned_size(); ++i)
          scratch.local_element(i) = -x.local_element(i);
        blocks.vmult_pressures(y, scratch);
      }

      /// The inverse of its diagonal.
      std::shared_ptr<PressureDiagonal>
      diagonal() const
      {
        auto  result  = std::make_shared<PressureDiagonal>();
        auto &d       = result->inverse;
        result->first = first;
        d             = blocks.schur_diagonal(D_inverse);
        for (unsigned int i = first; i < d.locally_owned_size(); ++i)
          d.local_element(i) = 1.f / d.local_element(i);
        return result;
      }

    private:
      const Blocks       &blocks;
      const unsigned int  first;
      const FloatVector   D_inverse;
      mutable FloatVector scratch;
    };

    /// S of the hat functions, formed: they couple with neighbours only.
    std::unique_ptr<Epetra_CrsMatrix>
    form_schur_complement(const HatBlocks &blocks)
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

    /// Whether nodes hardly move each other: at each, what couples its hat
    /// function with others is less than half of the diagonal. Lumped masses of
    /// fluids are so (0.01), consistent ones, stiff solids and viscous fluids
    /// are not (1 to 15). Collective.
    template <int dim>
    bool
    is_nearly_diagonal(const Epetra_CrsMatrix &A)
    {
      int    *start, *column;
      double *values;
      A.ExtractCrsDataPointers(start, column, values);
      int everywhere = 1;
      for (int row = 0; row < A.NumMyRows(); ++row)
        {
          double excess = 0.;
          for (int k = start[row]; k < start[row + 1]; ++k)
            {
              const int other = A.LRID(A.GCID(column[k])); // -1: not ours
              if (other == row)
                excess -= 0.5 * values[k];
              else if (other < 0 || other / dim != row / dim)
                excess += std::abs(values[k]);
            }
          everywhere = everywhere && excess <= 0.;
        }
      int everywhere_on_all = 0;
      A.Comm().MinAll(&everywhere, &everywhere_on_all, 1);
      return everywhere_on_all == 1;
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
    template <int dim, typename Blocks>
    class BlockTriangular : public Preconditioner
    {
    public:
      BlockTriangular(const System<dim>      &system,
                      const Epetra_CrsMatrix &hat_matrix)
        : first(system.n_owned_displacements())
        , hats(system, hat_matrix)
        , S_hats(form_schur_complement(hats))
        , blocks(system)
        , S(blocks, first)
        , S_inverse(S,
                    S.diagonal(),
                    float_vector(system),
                    first,
                    system.n_owned(),
                    std::make_unique<const Multigrid>(*S_hats,
                                                      1,
                                                      pressure_places(system)))
        , in(float_vector(system))
        , u(in)
        , p(in)
      {
        if (is_nearly_diagonal<dim>(*hats.A))
          A_diagonal = blocks.node_diagonal();
        else
          A = std::make_unique<Displacements>(system,
                                              *hats.A,
                                              blocks.displacements());
      }

      void
      vmult(Vector &x, const Vector &b) const override
      {
        in.copy_locally_owned_data_from(b);
        S_inverse.vmult(p, in);
        p *= -1.f;
        blocks.vmult_B(u, p);
        in -= u;
        for (unsigned int i = first; i < in.locally_owned_size(); ++i)
          in.local_element(i) = 0.f;
        if (A)
          A->inverse.vmult(u, in);
        else
          A_diagonal->vmult(u, in);
        u += p;
        x.copy_locally_owned_data_from(u);
      }

    private:
      using Displacements =
        DisplacementBlock<dim, typename Blocks::Displacements>;

      const unsigned int                              first; ///< pressure
      const HatBlocks                                 hats;
      const std::unique_ptr<Epetra_CrsMatrix>         S_hats;
      const Blocks                                    blocks;
      const Schur<Blocks>                             S;
      const TwoLevel<Schur<Blocks>, PressureDiagonal> S_inverse;
      std::unique_ptr<Displacements>                  A;
      std::shared_ptr<NodeDiagonal<dim, float>>       A_diagonal;
      mutable FloatVector                             in, u, p;
    };
  } // namespace


  template <int dim>
  std::unique_ptr<const Preconditioner>
  make_block_triangular(const System<dim> &system)
  {
    if (system.points())
      return std::make_unique<BlockTriangular<dim, PointBlocks<dim>>>(
        system, system.hats()->epetra());
    const auto &hats = system.hats() ? *system.hats() : system.matrix();
    return std::make_unique<BlockTriangular<dim, MatrixBlocks<dim>>>(
      system, hats.epetra());
  }

  template std::unique_ptr<const Preconditioner>
  make_block_triangular(const System<2> &);
  template std::unique_ptr<const Preconditioner>
  make_block_triangular(const System<3> &);
} // namespace selkie
