#pragma once

#include <selkie/laws/hyperelastic_law.h>
#include <selkie/shape/simd.h>

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/tensor.h>

#include <algorithm>
#include <vector>

#include "assembled_scene.h"

/// The tangent of a solid without a matrix, for matrix_free_benchmark.cc.
namespace matrix_free
{
  using namespace selkie;
  using dealii::AlignedVector;
  using dealii::Tensor;

  /// The tangents of as many points as V has lanes, whatever their law:
  /// PointForm::stiffness.
  template <int dim, typename V>
  struct AnyLaw
  {
    V C[dim][dim][dim][dim] = {};

    void
    set(const unsigned int lane, const PatchState<dim> &state, const unsigned q)
    {
      for (unsigned int j = 0; j < dim; ++j)
        for (unsigned int l = 0; l < dim; ++l)
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int k = 0; k < dim; ++k)
              C[i][j][k][l][lane] = state.forms[q].stiffness[j][l][i][k];
    }

    /// From gradients of the vector (grad_n) to what its forces are made of.
    void
    apply(const V (&H)[dim][dim], V (&flux)[dim][dim]) const
    {
#pragma GCC unroll 4
      for (int i = 0; i < dim; ++i)
#pragma GCC unroll 4
        for (int j = 0; j < dim; ++j)
          {
            V sum{};
#pragma GCC unroll 4
            for (int k = 0; k < dim; ++k)
#pragma GCC unroll 4
              for (int l = 0; l < dim; ++l)
                sum += C[i][j][k][l] * H[k][l];
            flux[i][j] = sum;
          }
    }
  };

  /// The same of a neo-Hookean solid: f^{-1}, stress and two moduli (design,
  /// section 2) instead of dim^4 numbers. V_0 is in all of them.
  template <int dim, typename V>
  struct NeoHookeanOnly
  {
    V f_inv[dim][dim] = {}, tau[dim][dim] = {}, Gamma1 = {}, half8 = {};

    void
    set(const unsigned int lane, const PatchState<dim> &state, const unsigned q)
    {
      const auto        &point = state.point(q);
      const auto        &kin   = state.kinematics[q];
      const Tensor<2, 3> F     = kin.f * extend(point.F_n);
      const Tensor<2, 3> b     = left_cauchy_green(F);
      const auto response = static_cast<const HyperelasticLaw &>(*point.law)
                              .response(invariants(b, determinant(F)));
      const Tensor<2, 3> stress = kirchhoff_stress(response, b);
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          {
            f_inv[i][j][lane] = kin.f_inv[i][j];
            tau[i][j][lane]   = point.volume * stress[i][j];
          }
      Gamma1[lane] = point.volume * response.Gamma[0];
      half8[lane]  = point.volume * 0.5 * response.Gamma[7];
    }

    void
    apply(const V (&H)[dim][dim], V (&flux)[dim][dim]) const
    {
      V h[dim][dim], trace{};
#pragma GCC unroll 4
      for (int i = 0; i < dim; ++i)
        {
#pragma GCC unroll 4
          for (int j = 0; j < dim; ++j)
            {
              h[i][j] = V{};
#pragma GCC unroll 4
              for (int k = 0; k < dim; ++k)
                h[i][j] += H[i][k] * f_inv[k][j];
            }
          trace += h[i][i];
        }
#pragma GCC unroll 4
      for (int i = 0; i < dim; ++i)
        {
          V row[dim];
#pragma GCC unroll 4
          for (int j = 0; j < dim; ++j)
            {
              row[j] = half8 * (h[i][j] + h[j][i]);
#pragma GCC unroll 4
              for (int k = 0; k < dim; ++k)
                row[j] += h[i][k] * tau[k][j];
            }
          row[i] += Gamma1 * trace;
#pragma GCC unroll 4
          for (int j = 0; j < dim; ++j)
            {
              flux[i][j] = V{};
#pragma GCC unroll 4
              for (int k = 0; k < dim; ++k)
                flux[i][j] += row[k] * f_inv[j][k];
            }
        }
    }
  };

  /**
   * The action of the tangent, patch by patch: gradients of the vector at each
   * point (nodes in the lanes), fluxes (points in the lanes), forces (nodes in
   * the lanes again). One rank, no prescribed unknowns.
   */
  template <int dim, typename Number, template <int, typename> class Tangent>
  class PointOperator
  {
  public:
    explicit PointOperator(const AssembledScene<dim> &block)
    {
      PatchState<dim> state;
      state.table = &block.table;
      state.time  = &block.time;
      gradients.resize_fast(block.table.points.size() * dim *
                            longest_list(block.table));
      std::size_t filled = 0;
      for (const auto &patch : block.table.patches)
        {
          add_nodes(block, patch, filled);
          for (unsigned int q = 0; q < patch.n_points; ++q)
            {
              const double *G = block.table.gradient(patch, q, 0);
              for (unsigned int k = 0; k < dim * patch.n_padded; ++k)
                gradients[filled++] = G[k];
            }
          add_tangents(block, patch, state);
        }
      gradients.resize_fast(filled);
      add_lumped_mass(block);
    }

    template <typename VectorType>
    void
    vmult(VectorType &y, const VectorType &x) const
    {
      for (unsigned int i = 0; i < diagonal.size(); ++i)
        y.local_element(i) = diagonal[i] * x.local_element(i);
      for (const Cell &cell : cells)
        {
          gather(cell, x.begin());
          set_fluxes(cell);
          add_forces(cell, y.begin());
        }
    }

    /// @param with_gradients those of the support table can be used instead
    std::size_t
    bytes(const bool with_gradients) const
    {
      return tangents.size() * sizeof(tangents[0]) +
             unknowns.size() * sizeof(unknowns[0]) +
             diagonal.size() * sizeof(Number) +
             (with_gradients ? gradients.size() * sizeof(Number) : 0);
    }

  private:
    using V                             = simd::NativeOf<Number>;
    static constexpr unsigned int lanes = sizeof(V) / sizeof(Number);

    struct Cell
    {
      unsigned int n_points, n_nodes, n_padded, first_unknown, first_tangent;
      std::size_t  first_gradient;
    };

    static unsigned int
    longest_list(const SupportTable<dim> &table)
    {
      unsigned int n = 0;
      for (const auto &patch : table.patches)
        n = std::max(n, patch.n_padded);
      return n;
    }

    void
    add_nodes(const AssembledScene<dim> &block,
              const Patch<dim>          &patch,
              const std::size_t          first_gradient)
    {
      cells.push_back({patch.n_points,
                       patch.n_nodes,
                       patch.n_padded,
                       unsigned(unknowns.size()),
                       unsigned(tangents.size()),
                       first_gradient});
      for (unsigned int a = 0; a < patch.n_nodes; ++a)
        unknowns.push_back(
          block.system->displacement(block.table.nodes[patch.first_node + a]));
      if (values.size() < dim * patch.n_padded)
        values.resize(dim * patch.n_padded);
      fluxes.resize(std::max<std::size_t>(fluxes.size(),
                                          (patch.n_points + lanes - 1) / lanes *
                                            lanes * dim * dim));
    }

    /// At increments of zero, as Block assembles.
    void
    add_tangents(const AssembledScene<dim> &block,
                 const Patch<dim>          &patch,
                 PatchState<dim>           &state)
    {
      state.patch = &patch;
      state.h     = patch.cell->extent_in_direction(0);
      state.forms.assign(patch.n_points, PointForm<dim>());
      state.kinematics.resize(patch.n_points);
      for (auto &kin : state.kinematics)
        {
          kin.f = kin.f_inv = dealii::unit_symmetric_tensor<3>();
          for (unsigned int j = 0; j < dim; ++j)
            for (unsigned int i = 0; i < 3; ++i)
              kin.c[j][i] = kin.f_inv[j][i];
        }
      for (const auto &term : block.terms)
        if (term->acts_on(patch))
          term->add(state, true);
      for (unsigned int q = 0; q < patch.n_points; ++q)
        {
          if (q % lanes == 0)
            tangents.emplace_back();
          tangents.back().set(q % lanes, state, q);
        }
    }

    void
    add_lumped_mass(const AssembledScene<dim> &block)
    {
      Vector residual, sum, acceleration;
      for (Vector *v : {&residual, &sum, &acceleration})
        block.system->initialize(*v);
      const NodeState nodes{block.fields.mass, acceleration};
      for (const auto &term : block.terms)
        term->add_at_nodes(nodes, block.time.newmark, residual, &sum);
      diagonal.resize(sum.locally_owned_size());
      for (unsigned int i = 0; i < diagonal.size(); ++i)
        diagonal[i] = sum.local_element(i);
    }

    void
    gather(const Cell &cell, const Number *x) const
    {
      Number *to = values.data();
      for (unsigned int a = 0; a < cell.n_padded; ++a)
        {
          const bool    is_node = a < cell.n_nodes;
          const Number *from =
            is_node ? x + unknowns[cell.first_unknown + a] : x;
#pragma GCC unroll 4
          for (int d = 0; d < dim; ++d)
            to[d * cell.n_padded + a] = is_node ? from[d] : Number(0);
        }
    }

    void
    set_fluxes(const Cell &cell) const
    {
      const Number *G = gradients.data() + cell.first_gradient;
      for (unsigned int first = 0; first < cell.n_points; first += lanes)
        {
          V H[dim][dim] = {}, flux[dim][dim];
          for (unsigned int lane = 0;
               lane < lanes && first + lane < cell.n_points;
               ++lane, G += dim * cell.n_padded)
            add_gradient(cell, G, lane, H);
          tangents[cell.first_tangent + first / lanes].apply(H, flux);
          for (int i = 0; i < dim; ++i)
            for (int j = 0; j < dim; ++j)
              for (unsigned int lane = 0; lane < lanes; ++lane)
                fluxes[(first + lane) * dim * dim + i * dim + j] =
                  flux[i][j][lane];
        }
    }

    /// The gradient at a point, in its lane.
    void
    add_gradient(const Cell        &cell,
                 const Number      *G,
                 const unsigned int lane,
                 V (&H)[dim][dim]) const
    {
      V sum[dim][dim] = {};
      for (unsigned int a = 0; a < cell.n_padded; a += lanes)
#pragma GCC unroll 4
        for (int i = 0; i < dim; ++i)
          {
            const V x = simd::load<V>(values.data() + i * cell.n_padded + a);
#pragma GCC unroll 4
            for (int j = 0; j < dim; ++j)
              sum[i][j] += x * simd::load<V>(G + j * cell.n_padded + a);
          }
#pragma GCC unroll 4
      for (int i = 0; i < dim; ++i)
#pragma GCC unroll 4
        for (int j = 0; j < dim; ++j)
          H[i][j][lane] = simd::sum(sum[i][j]);
    }

    void
    add_forces(const Cell &cell, Number *y) const
    {
      for (unsigned int a = 0; a < cell.n_padded; a += lanes)
        {
          const Number *G        = gradients.data() + cell.first_gradient + a;
          const Number *flux     = fluxes.data();
          V             sum[dim] = {};
          for (unsigned int q = 0; q < cell.n_points; ++q, flux += dim * dim)
#pragma GCC unroll 4
            for (int j = 0; j < dim; ++j, G += cell.n_padded)
              {
                const V g = simd::load<V>(G);
#pragma GCC unroll 4
                for (int i = 0; i < dim; ++i)
                  sum[i] += flux[i * dim + j] * g;
              }
          const unsigned int  n  = std::min(lanes, cell.n_nodes - a);
          const unsigned int *to = unknowns.data() + cell.first_unknown + a;
          for (unsigned int k = 0; k < n; ++k)
#pragma GCC unroll 4
            for (int d = 0; d < dim; ++d)
              y[to[k] + d] += sum[d][k];
        }
    }

    std::vector<Cell>            cells;
    std::vector<unsigned int>    unknowns; ///< first of each node of a list
    AlignedVector<Number>        gradients;
    std::vector<Tangent<dim, V>> tangents; ///< of some points each
    std::vector<Number>          diagonal; ///< of the lumped mass
    // scratch
    mutable AlignedVector<Number> values;
    mutable std::vector<Number>   fluxes;
  };
} // namespace matrix_free
